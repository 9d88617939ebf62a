#include "bench/peers/narrow/measure.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>

#include "bench/peers/common.hpp"
#include "bench/peers/narrow/worker.hpp"

namespace clinch::peers::narrow {
namespace {

/// Slower peers have two turns only.
constexpr double slow_ms = 3000.0;

/// How many times longer turns on all cores are: threads that slept start out on one core where others are at work, and
/// take a while to spread.
constexpr double longer_on_all_cores = 10.0;

/// A peer on its way through the rounds.
struct Runner {
    Result result;
    std::unique_ptr<Worker> worker;
    unsigned rounds = 0;
};

/// Whether the peer goes on; if not, the note says why.
bool goes_on(Runner& runner, const Turn& turn) {
    // Threads of the peer before stop spinning meanwhile.
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (turn.done) {
        runner.result.peak_bytes = std::max(runner.result.peak_bytes, turn.peak_bytes);
        return true;
    }
    runner.result.note = turn.text.data();
    runner.worker.reset();
    return false;
}

void first_run(Runner& runner, const Batch& batch, Question question, const Rules& rules) {
    runner.worker = std::make_unique<Worker>(runner.result.row, batch, question, rules.core);
    const Turn turn = runner.worker->first_run(3.0 * rules.most_seconds);
    if (!goes_on(runner, turn)) return;
    if (runner.result.row.group != Group::Yardstick) runner.result.verdict = turn.verdict;
    runner.rounds = turn.ms[0] > slow_ms ? std::min(rules.rounds, 2u) : rules.rounds;
}

void next_runs(Runner& runner, double pairs, const Rules& rules) {
    const double enough_ms = (runner.result.row.one_core ? 1.0 : longer_on_all_cores) * rules.enough_ms;
    const Turn turn = runner.worker->more_runs(enough_ms, rules.most_seconds);
    if (!goes_on(runner, turn)) return;
    for (unsigned i = 0; i < turn.runs; ++i) {
        runner.result.ns.push_back(1e6 * turn.ms[i] / pairs);
        runner.result.cpu_ns.push_back(1e6 * turn.cpu_ms[i] / pairs);
        if (turn.routines_ms[i] > 0.0) runner.result.routines_ns.push_back(1e6 * turn.routines_ms[i] / pairs);
    }
}

}  // namespace

double Result::median_ns() const {
    return median(ns);
}

double Result::least_ns() const {
    return least(ns);
}

double Result::spread() const {
    if (ns.empty()) return 0.0;
    std::vector<double> sorted = ns;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t last = sorted.size() - 1;
    return (sorted[last - last / 4] - sorted[last / 4]) / median_ns();
}

std::vector<Result> measure(const Batch& batch, Question question, const std::vector<PeerRow>& rows,
                            const Rules& rules) {
    std::vector<Runner> runners;
    for (const PeerRow& row : rows) {
        Runner runner;
        runner.result.row = row;
        runner.result.pairs = batch.pairs();
        if (row.make)
            first_run(runner, batch, question, rules);
        else
            runner.result.note = "left out of this build: needs " + row.package;
        runners.push_back(std::move(runner));
    }
    for (unsigned round = 0; round < rules.rounds; ++round)
        for (Runner& runner : runners)
            if (runner.worker && round < runner.rounds) next_runs(runner, static_cast<double>(batch.pairs()), rules);
    std::vector<Result> results;
    results.reserve(runners.size());
    for (Runner& runner : runners) results.push_back(std::move(runner.result));
    return results;
}

const Result* fastest_library(const std::vector<Result>& results, bool right) {
    const Result* best = nullptr;
    for (const Result& r : results) {
        if (r.row.group != Group::Library || r.ns.empty() || (right && !r.right(forgiven))) continue;
        if (best == nullptr || r.least_ns() < best->least_ns()) best = &r;
    }
    return best;
}

const Result* find(const std::vector<Result>& results, const std::string& name) {
    for (const Result& r : results)
        if (r.row.name == name && !r.ns.empty()) return &r;
    return nullptr;
}

}  // namespace clinch::peers::narrow
