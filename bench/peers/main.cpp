// clinch_peers: times clinch's algorithms and other libraries on the same boxes, checks that all find the same
// pairs, prints a table and writes JSON for bench/plot_peers.py.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/peers/choice.hpp"
#include "bench/peers/common.hpp"
#include "bench/peers/measure.hpp"
#include "bench/scenes/boxes.hpp"

namespace {

using namespace clinch;
using namespace clinch::peers;

struct Options {
    std::vector<std::string> scenes{"uniform:1000",    "uniform:10000",   "uniform:100000",  "uniform:500000",
                                    "uniform:1000000", "density:100000",  "density:1000000", "density:4000000",
                                    "mixed:1000000",   "clusters:1000000"};
    std::vector<std::string> peers, without;
    std::string output;
    std::uint64_t seed = 1;
    double gibibytes = 8.0;
    Rules rules;
    bool list = false;
    bool choice = false;
    std::vector<std::string> kinds;
    std::vector<std::size_t> counts{10000, 100000, 1000000};
};

const char* name_of(Group group) {
    switch (group) {
        case Group::Clinch:
            return "clinch";
        case Group::Lossy:
            return "lossy";
        case Group::Yardstick:
            return "yardstick";
        default:
            return "library";
    }
}

/// KIND:N
SceneName scene_of(const std::string& text, std::uint64_t seed) {
    const std::size_t colon = text.find(':');
    std::size_t used = 0;
    if (colon == std::string::npos || colon + 1 == text.size() ||
        text.find_first_not_of("0123456789", colon + 1) < text.size())
        throw CLI::ValidationError("--scenes", "'" + text + "' is not of the form KIND:N");
    const unsigned long long count = std::stoull(text.substr(colon + 1), &used);
    if (count > 100000000) throw CLI::ValidationError("--scenes", "'" + text + "' asks for more than 1e8 boxes");
    return {text.substr(0, colon), static_cast<std::size_t>(count), seed};
}

/// Those whose names begin with one of `wanted` (all for none) and with none of `without`.
std::vector<PeerRow> chosen(const std::vector<std::string>& wanted, const std::vector<std::string>& without) {
    std::vector<PeerRow> rows;
    for (PeerRow& row : peer_rows())
        if ((wanted.empty() || begins_with_any(row.name, wanted)) && !begins_with_any(row.name, without))
            rows.push_back(std::move(row));
    return rows;
}

void print(const Outcome& outcome) {
    std::printf("\n%s, %zu boxes, seed %llu: %llu pairs\n", outcome.scene.kind.c_str(), outcome.scene.count,
                static_cast<unsigned long long>(outcome.scene.seed), static_cast<unsigned long long>(outcome.pairs));
    for (const Result& r : outcome.results) {
        std::printf("  %-26s", r.row.name.c_str());
        if (!r.ms.empty())
            std::printf("%11.3f ms (least %.3f, %zu runs) %6.0f MiB", r.median_ms(),
                        *std::min_element(r.ms.begin(), r.ms.end()), r.ms.size(),
                        static_cast<double>(r.peak_bytes) / 1048576.0);
        if (!r.ms.empty() && !r.right) std::printf("  WRONG: %llu pairs", static_cast<unsigned long long>(r.pairs));
        std::printf("%s%s\n", r.note.empty() ? "" : "  ", r.note.c_str());
    }
    std::fflush(stdout);
}

nlohmann::ordered_json json_of(const Outcome& outcome, const Rules& rules) {
    nlohmann::ordered_json results = nlohmann::ordered_json::array();
    for (const Result& r : outcome.results) {
        nlohmann::ordered_json row{
            {"peer", r.row.name}, {"group", name_of(r.row.group)}, {"threads", r.row.threaded ? rules.threads : 1u},
            {"ms", nullptr},      {"runs", r.ms.size()},           {"pairs", r.pairs},
            {"right", r.right},   {"peak_bytes", r.peak_bytes},    {"note", r.note},
            {"chosen", r.chosen}};
        if (!r.ms.empty()) {
            row["ms"] = r.median_ms();
            row["least_ms"] = *std::min_element(r.ms.begin(), r.ms.end());
        }
        results.push_back(std::move(row));
    }
    return {{"kind", outcome.scene.kind},
            {"boxes", outcome.scene.count},
            {"seed", outcome.scene.seed},
            {"pairs", outcome.pairs},
            {"results", std::move(results)}};
}

void add_options(CLI::App& app, Options& o) {
    app.add_option("--scenes", o.scenes, "KIND:N,... (kinds: clinch scene --help)")
        ->delimiter(',')
        ->capture_default_str();
    app.add_option("--seed", o.seed, "Seed of the scenes")->capture_default_str();
    app.add_option("--peers", o.peers, "Only peers whose names begin so: clinch/auto,embree,...")->delimiter(',');
    app.add_option("--without", o.without, "No peers whose names begin so")->delimiter(',');
    app.add_option("--rounds", o.rules.rounds, "Rounds over all peers; those above 3 s a run get two")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    app.add_option("--turn", o.rules.enough_ms, "Milliseconds a peer runs on in its turn, at least one run")
        ->check(CLI::Range(0.0, 1e5))
        ->capture_default_str();
    app.add_option("--limit", o.rules.most_seconds, "Seconds after which a peer's turn is given up")
        ->check(CLI::Range(0.1, 1e5))
        ->capture_default_str();
    app.add_option("--threads", o.rules.threads, "Threads of libraries that can use several")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
    app.add_option("--memory", o.gibibytes, "GiB all peers may take together; above it they live one at a time")
        ->check(CLI::Range(0.0, 1e5))
        ->capture_default_str();
    app.add_flag("--choice", o.choice,
                 "Instead of --scenes: `auto` beside clinch's own algorithms and the libraries on every kind of scene");
    app.add_option("--kinds", o.kinds, "Kinds of scene for --choice (default: all)")->delimiter(',');
    app.add_option("--counts", o.counts, "Boxes of the scenes of --choice, ascending")
        ->delimiter(',')
        ->capture_default_str();
    app.add_option("--hopeless", o.rules.hopeless,
                   "After a first round, peers so many times slower than the fastest run no more; 0: all do "
                   "(4 for --choice)")
        ->check(CLI::Range(0.0, 1e5));
    app.add_option("-o,--output", o.output, "JSON to write, anew after each scene");
    app.add_flag("--list", o.list, "Print the peers' names, nothing else");
}

int run(const Options& options) {
    const std::vector<PeerRow> rows = chosen(options.peers, options.without);
    if (options.list) {
        for (const PeerRow& row : rows)
            std::printf("%-26s %s%s\n", row.name.c_str(), name_of(row.group),
                        row.make ? "" : ", left out of this build");
        return 0;
    }
    Rules rules = options.rules;
    rules.most_bytes = static_cast<std::uint64_t>(options.gibibytes * 1073741824.0);
    nlohmann::ordered_json all{
        {"processor", processor()}, {"threads", rules.threads}, {"scenes", nlohmann::ordered_json::array()}};
    std::vector<SceneName> names;
    for (const std::string& text : options.scenes) names.push_back(scene_of(text, options.seed));
    bool right = true;
    const auto done = [&](const Outcome& outcome) {
        for (const Result& r : outcome.results)
            right = right && (r.right || r.ms.empty() || r.row.group == Group::Lossy);
        all["scenes"].push_back(json_of(outcome, rules));
        if (options.output.empty()) return;
        std::ofstream file(options.output);
        file << all.dump(1) << '\n';
        if (!file) throw std::runtime_error("'" + options.output + "' is not writable");
    };
    if (options.choice) {
        if (rules.hopeless == 0.0) rules.hopeless = 4.0;
        measure_choice(rows, {options.kinds, options.counts, options.seed}, rules, done);
    } else {
        for (const SceneName& scene : names) {
            const Outcome outcome = measure(scene, rows, rules);
            print(outcome);
            done(outcome);
        }
    }
    if (!right) std::fprintf(stderr, "clinch_peers: not all peers found the same pairs; see WRONG above\n");
    return right ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        CLI::App app("clinch beside other libraries: the same boxes, the same minute, the same pairs");
        Options options;
        add_options(app, options);
        CLI11_PARSE(app, argc, argv);
        return run(options);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "clinch_peers: %s\n", error.what());
        return 1;
    }
}
