// clinch_phases: what it brings that both phases of a step work at once, and how well their balance follows scenes of
// falling bodies, as JSON. See bench/plot_phases.py.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <exception>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "bench/cpu_parts.hpp"
#include "bench/phases/replay.hpp"
#include "bench/phases/streaming.hpp"
#include "bench/scenes/falling.hpp"
#include "clinch/aabb.hpp"

namespace {

using namespace clinch::phases;
using Json = nlohmann::ordered_json;

struct Options {
    std::string path;
    std::vector<std::string> kinds;  // empty: all
    double factor = 1.0;
    std::size_t every = 8;
    std::uint32_t contacts_per_pair = 1;
    std::uint64_t seed = 1;
};

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

template <class Of>
std::vector<double> of_all(const std::vector<Frame>& frames, const Of& of) {
    std::vector<double> values;
    values.reserve(frames.size());
    for (const Frame& frame : frames) values.push_back(of(frame));
    return values;
}

double percent_less(double value, double than) {
    return 100.0 * (1.0 - value / than);
}

// Each way's times, and by how much they are less than those of the sequence.
Json ways_of(const std::vector<Frame>& frames) {
    const double sequence = mean(of_all(frames, [](const Frame& frame) { return frame.ms[0]; }));
    Json ways = Json::array();
    for (std::size_t way = 0; way < way_names.size(); ++way) {
        const std::vector<double> ms = of_all(frames, [way](const Frame& frame) { return frame.ms[way]; });
        const std::vector<double> less =
            of_all(frames, [way](const Frame& frame) { return percent_less(frame.ms[way], frame.ms[0]); });
        ways.push_back({{"name", way_names[way]},
                        {"mean_ms", mean(ms)},
                        {"median_ms", median(ms)},
                        {"reduction_percent", percent_less(mean(ms), sequence)},
                        {"median_reduction_percent", median(less)}});
    }
    return ways;
}

Json frames_of(const std::vector<Frame>& frames) {
    Json all = Json::array();
    for (const Frame& frame : frames)
        all.push_back({{"frame", frame.frame},
                       {"pairs", frame.pairs},
                       {"contacts", frame.contacts},
                       {"ms", frame.ms},
                       {"broad_ms", frame.broad_ms},
                       {"narrow_ms", frame.narrow_ms},
                       {"pair_bytes", frame.pair_bytes}});
    return all;
}

Json to_json(const Play& play, const Played& played) {
    const std::vector<Frame>& frames = played.stepped;
    std::uint64_t streamed = 0, listed = 0;
    for (const Frame& frame : frames) {
        streamed = std::max(streamed, frame.pair_bytes);
        listed = std::max<std::uint64_t>(listed, sizeof(clinch::Pair) * frame.pairs);
    }
    return {{"kind", play.kind},
            {"bodies", play.bodies},
            {"frames", played.frames},
            {"pairs_at_rest", played.rest.pairs},
            {"contacts_at_rest", played.rest.contacts},
            {"ways", ways_of(frames)},
            {"broad_ms", mean(of_all(frames, [](const Frame& frame) { return frame.broad_ms; }))},
            {"narrow_ms", mean(of_all(frames, [](const Frame& frame) { return frame.narrow_ms; }))},
            {"most_pair_bytes", streamed},
            {"most_listed_pair_bytes", listed},
            {"measured", frames_of(frames)}};
}

Json to_json(const Replay& run) {
    const auto steps = static_cast<double>(run.balanced.seconds.size());
    return {{"units", run.units},
            {"share_near_best", static_cast<double>(run.near_best) / steps},
            {"share_near_best_unsmoothed", static_cast<double>(run.near_best_unsmoothed) / steps},
            {"moves", run.balanced.moves},
            {"checks", run.balanced.checks},
            {"broad_units", run.balanced.broad_units},
            {"seconds", run.balanced.seconds},
            {"best_seconds", run.balanced.best},
            {"fixed_seconds", run.fixed}};
}

Json balance_of(const Play& play, const std::vector<clinch::machines::PhaseLoad>& loads, std::uint64_t seed) {
    std::vector<double> broad, narrow;
    for (const clinch::machines::PhaseLoad& load : loads) {
        broad.push_back(1e3 * load.broad);
        narrow.push_back(1e3 * load.narrow);
    }
    Json runs = Json::array();
    for (const Replay& run : replay(loads, seed)) runs.push_back(to_json(run));
    return {{"kind", play.kind}, {"bodies", play.bodies}, {"steps", loads.size()},
            {"broad_ms", broad}, {"narrow_ms", narrow},   {"runs", runs}};
}

// Of each way, the mean over the scenes.
Json averages(const Json& scenes) {
    Json all = Json::array();
    for (std::size_t way = 0; way < way_names.size(); ++way) {
        std::vector<double> reductions, medians;
        for (const Json& scene : scenes) {
            reductions.push_back(scene["ways"][way]["reduction_percent"]);
            medians.push_back(scene["ways"][way]["median_reduction_percent"]);
        }
        all.push_back({{"name", way_names[way]},
                       {"reduction_percent", mean(reductions)},
                       {"median_reduction_percent", mean(medians)}});
    }
    return all;
}

std::vector<Play> plays(const Options& options) {
    std::vector<Play> chosen;
    for (const clinch::scenes::FallingKind& kind : clinch::scenes::falling_kinds()) {
        const bool wanted = options.kinds.empty() || std::find(options.kinds.begin(), options.kinds.end(),
                                                               kind.kind.name) != options.kinds.end();
        if (!wanted) continue;
        const double bodies = std::max(1.0, std::round(options.factor * static_cast<double>(kind.usual)));
        chosen.push_back({kind.kind.name, static_cast<std::size_t>(bodies), options.seed, options.contacts_per_pair});
    }
    return chosen;
}

Json measure(const Options& options) {
    const std::optional<clinch::DeviceInfo> cpu = clinch::bench::largest_cpu();
    if (!cpu || cpu->compute_units < 2)
        throw std::runtime_error("needs a CPU of two compute units or more that PoCL offers; there is none here");
    Bench bench(*cpu);
    Json streaming = Json::array(), scenes = Json::array();
    for (const Play& play : plays(options)) {
        const Played played = bench.compare(play, options.every);
        if (played.stepped.empty())
            throw std::runtime_error(play.kind + ": --every " + std::to_string(options.every) + " of only " +
                                     std::to_string(played.frames) + " frames measures none");
        streaming.push_back(to_json(play, played));
        scenes.push_back(balance_of(play, bench.loads(play), options.seed));
    }
    const Json average = averages(streaming);
    return {{"program", "clinch_phases"},
            {"device", cpu->name + ", " + std::to_string(cpu->compute_units) + " compute units, each a device"},
            {"seed", options.seed},
            {"factor", options.factor},
            {"every", options.every},
            {"contacts_per_pair", options.contacts_per_pair},
            {"streaming", {{"scenes", streaming}, {"averages", average}}},
            {"balance", {{"assumptions", assumptions()}, {"scenes", scenes}}}};
}

void write(const Json& content, const std::string& path) {
    if (path.empty()) {
        std::cout << content.dump(1) << '\n';
        return;
    }
    std::ofstream file(path);
    file << content.dump(1) << '\n';
    file.close();
    if (!file) throw std::runtime_error("cannot write " + path);
}

int run(int argc, char** argv) {
    CLI::App app(
        "Plays scenes of falling bodies and writes, as JSON, the times of steps with both phases at once on two cores "
        "beside those with one after the other, and how the split of more units between the phases follows the scenes");
    Options options;
    std::vector<std::string> known;
    for (const clinch::scenes::FallingKind& kind : clinch::scenes::falling_kinds()) known.emplace_back(kind.kind.name);
    app.add_option("-o,--output", options.path, "default: standard output");
    app.add_option("--kind", options.kinds, "scenes, in any number; default all")->check(CLI::IsMember(known));
    app.add_option("--factor", options.factor, "times the usual number of bodies; default 1")
        ->check(CLI::Range(1e-4, 1e4));
    app.add_option("--every", options.every, "measure one of so many frames, four in a row; default 8")
        ->check(CLI::Range(1, 1000));
    app.add_option("--contacts-per-pair", options.contacts_per_pair, "1 to 8; default 1")->check(CLI::Range(1, 8));
    app.add_option("--seed", options.seed, "of the scenes; default 1");
    CLI11_PARSE(app, argc, argv);
    write(measure(options), options.path);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        std::cerr << "clinch_phases: " << error.what() << '\n';
        return 1;
    }
}
