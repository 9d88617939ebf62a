// clinch_narrow_peers: times clinch's narrow phase and other libraries on the same pairs in the same poses, judges the
// answers of all, prints tables and writes JSON.
#include <omp.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/peers/common.hpp"
#include "bench/peers/narrow/measure.hpp"
#include "bench/peers/narrow/table.hpp"

namespace {

using namespace clinch::peers;
using namespace clinch::peers::narrow;

struct Options {
    std::vector<std::string> cells{
        "sphere-sphere", "sphere-box",      "sphere-capsule", "sphere-plane",      "box-box",          "box-capsule",
        "box-plane",     "capsule-capsule", "capsule-plane",  "cylinder-cylinder", "cylinder-plane",   "cone-cone",
        "box-hull:32",   "hull:32-plane",   "hull:8-hull:8",  "hull:32-hull:32",   "hull:128-hull:128"};
    std::vector<std::string> jobs, peers, without;
    std::string output;
    std::size_t pairs = 100000, shapes = 64, oracle = 200;
    std::uint64_t seed = 1;
    Rules rules;
    bool list = false;
};

void add_options(CLI::App& app, Options& o) {
    app.add_option("--cells", o.cells,
                   "Pairs of shapes: of sphere, box, capsule, cylinder, cone, hull:VERTICES, and plane as the second")
        ->delimiter(',')
        ->capture_default_str();
    app.add_option("--jobs", o.jobs, "Of contact, distance, apart, overlapping (default: all)")->delimiter(',');
    app.add_option("--peers", o.peers, "Beginnings of peers' names (default: all)")->delimiter(',');
    app.add_option("--without", o.without, "Beginnings of names of peers left out")->delimiter(',');
    app.add_option("--pairs", o.pairs, "Pairs of a batch")->check(CLI::Range(1, 10000000))->capture_default_str();
    app.add_option("--shapes", o.shapes, "Different shapes on each side of a cell")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    app.add_option("--seed", o.seed, "Of shapes and poses")->capture_default_str();
    app.add_option("--oracle", o.oracle, "Pairs of a batch whose truth is checked; fewer of hulls of many vertices")
        ->capture_default_str();
    app.add_option("--rounds", o.rules.rounds, "Turns each peer takes; those above 3 s a run get two")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    app.add_option("--turn", o.rules.enough_ms, "Milliseconds a peer runs on in its turn, at least one run")
        ->check(CLI::Range(0.0, 1e5))
        ->capture_default_str();
    app.add_option("--limit", o.rules.most_seconds, "Seconds after which a peer's turn is given up")
        ->check(CLI::Range(0.1, 1e5))
        ->capture_default_str();
    app.add_option("--core", o.rules.core, "The core that peers of one core are bound to")->capture_default_str();
    app.add_option("-o,--output", o.output, "JSON to write, anew after each table");
    app.add_flag("--list", o.list, "Print the peers' names, nothing else");
}

std::vector<PeerRow> chosen(const Options& options) {
    std::vector<PeerRow> rows;
    for (PeerRow& row : peer_rows())
        if ((options.peers.empty() || begins_with_any(row.name, options.peers)) &&
            !begins_with_any(row.name, options.without))
            rows.push_back(std::move(row));
    return rows;
}

std::vector<Job> chosen_jobs(const std::vector<std::string>& names) {
    if (names.empty()) return jobs();
    std::vector<Job> out;
    for (const std::string& name : names) {
        const auto found = std::find_if(jobs().begin(), jobs().end(), [&](const Job& job) { return job.name == name; });
        if (found == jobs().end()) throw std::invalid_argument("'" + name + "' is no job");
        out.push_back(*found);
    }
    return out;
}

double truth_error(const Batch& batch) {
    double most = 0.0;
    for (std::size_t i = 0; i < batch.pairs(); ++i) most = std::max(most, batch.truth[i].error / batch.size[i]);
    return most;
}

/// clinch that is wrong is a failure; what libraries are is only shown.
bool clinch_is_right(const Outcome& outcome) {
    return std::all_of(outcome.results.begin(), outcome.results.end(), [&](const Result& r) {
        const bool not_asked = r.row.name == "clinch/points" && outcome.job.question != Question::Contact;
        return r.row.group != Group::Clinch || not_asked ||
               (r.right() && r.note.empty() && r.verdict->wrong_normal == 0 && r.verdict->wrong_point == 0);
    });
}

/// A batch for each regime that a job wants, made once; the truth checked.
class Batches {
public:
    explicit Batches(const Options& options) : options_(options) {}
    struct Checked {
        Batch batch;
        OracleCheck oracle;
    };
    const Checked& of(const Cell& cell, Regime regime) {
        if (name_ != cell.name) made_.clear();
        name_ = cell.name;
        const auto known = made_.find(regime);
        if (known != made_.end()) return known->second;
        Checked checked{make_batch(cell, regime, options_.pairs, options_.shapes, options_.seed), {}};
        checked.oracle = check_truth(checked.batch, options_.oracle);
        return made_.emplace(regime, std::move(checked)).first->second;
    }

private:
    const Options& options_;
    std::string name_;
    std::map<Regime, Checked> made_;
};

void write(const std::string& file_name, const nlohmann::ordered_json& json) {
    if (file_name.empty()) return;
    std::ofstream file(file_name);
    file << json.dump(1) << '\n';
    if (!file) throw std::runtime_error("'" + file_name + "' is not writable");
}

int run(const Options& options) {
    const std::vector<PeerRow> rows = chosen(options);
    if (options.list) {
        for (const PeerRow& row : rows)
            std::printf("%s%s\n", row.name.c_str(), row.make ? "" : ", left out of this build");
        return 0;
    }
    std::vector<Cell> cells;
    for (const std::string& text : options.cells) cells.push_back(cell_of(text));
    nlohmann::ordered_json all{{"processor", processor()},
                               {"cores", sysconf(_SC_NPROCESSORS_ONLN)},
                               {"seed", options.seed},
                               {"outcomes", nlohmann::ordered_json::array()}};
    std::printf("%s, seed %llu\n", processor().c_str(), static_cast<unsigned long long>(options.seed));
    Batches batches(options);
    std::vector<Outcome> outcomes;
    bool right = true;
    for (const Cell& cell : cells)
        for (const Job& job : chosen_jobs(options.jobs)) {
            const auto& [batch, oracle] = batches.of(cell, job.regime);
            outcomes.push_back({cell, job, batch.pairs(), truth_error(batch), oracle,
                                measure(batch, job.question, rows, options.rules)});
            print(outcomes.back());
            right = right && clinch_is_right(outcomes.back()) && oracle.worst < right_within;
            all["outcomes"].push_back(json_of(outcomes.back()));
            write(options.output, all);
        }
    print_summary(outcomes);
    if (!right) std::fprintf(stderr, "clinch_narrow_peers: clinch, or the truth, is wrong; see above\n");
    return right ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        omp_set_num_threads(1);  // threads do not survive the forks to come
        CLI::App app("clinch's narrow phase beside other libraries: the same poses, the same minute, judged answers");
        Options options;
        add_options(app, options);
        CLI11_PARSE(app, argc, argv);
        return tbb::task_arena(1).execute([&] { return run(options); });
    } catch (const std::exception& error) {
        std::fprintf(stderr, "clinch_narrow_peers: %s\n", error.what());
        return 1;
    }
}
