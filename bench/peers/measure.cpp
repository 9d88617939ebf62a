#include "bench/peers/measure.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>

#include "bench/peers/common.hpp"
#include "bench/peers/worker.hpp"
#include "bench/scenes/boxes.hpp"

namespace clinch::peers {
namespace {

/// Slower peers are run twice only.
constexpr double slow_ms = 3000.0;

/// A peer on its way through the rounds.
struct Runner {
    Result result;
    std::unique_ptr<Worker> worker;
    unsigned rounds = 0;
};

/// Threads of the peer before stop spinning meanwhile.
void rest() {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

/// Whether the peer goes on; if not, the note says why.
bool goes_on(Runner& runner, const Answer& answer) {
    rest();
    if (answer.done) return true;
    runner.result.note = answer.text.data();
    runner.worker.reset();
    return false;
}

bool first_run(Runner& runner, const Scenes& scenes, const Setup& setup, const Rules& rules) {
    runner.worker = std::make_unique<Worker>(runner.result.row, scenes, setup);
    const Answer answer = runner.worker->first_run(2.0 * rules.most_seconds);
    if (!goes_on(runner, answer)) return false;
    runner.result.pairs = answer.pairs;
    runner.result.mark = answer.mark;
    runner.result.peak_bytes = answer.peak_bytes;
    runner.rounds = answer.ms[0] > slow_ms ? std::min(rules.rounds, 2u) : rules.rounds;
    return true;
}

bool warm_up(Runner& runner, const Scenes& scenes, const Setup& setup, const Rules& rules) {
    runner.worker = std::make_unique<Worker>(runner.result.row, scenes, setup);
    return goes_on(runner, runner.worker->warm_up(runner.result.pairs, rules.most_seconds));
}

void next_run(Runner& runner, const Rules& rules) {
    const Answer answer = runner.worker->more_runs(rules.enough_ms, rules.most_seconds);
    if (!goes_on(runner, answer)) return;
    Result& result = runner.result;
    result.ms.insert(result.ms.end(), answer.ms.begin(), answer.ms.begin() + answer.runs);
    result.peak_bytes = std::max(result.peak_bytes, answer.peak_bytes);
    result.chosen = answer.chosen.data();
}

/// The shortest run, which noise lengthens least; 0 without any.
double least_ms(const Result& result) {
    return result.ms.empty() ? 0.0 : *std::min_element(result.ms.begin(), result.ms.end());
}

/// That of the fastest peer that found all pairs; 0 without one.
double fastest_ms(const std::vector<Runner>& runners) {
    double least = 0.0;
    for (const Runner& runner : runners) {
        const double ms = least_ms(runner.result);
        if (runner.result.right && ms > 0.0 && (least == 0.0 || ms < least)) least = ms;
    }
    return least;
}

/// Peers are made one at a time, since those that follow are told how many pairs there are.
std::vector<Runner> first_runs(Outcome& outcome, const Scenes& scenes, const std::vector<PeerRow>& rows,
                               const Rules& rules, bool& together) {
    std::vector<Runner> runners;
    bool known = false;
    std::uint64_t mark = 0;
    for (const PeerRow& row : rows) {
        Runner runner;
        runner.result.row = row;
        if (!row.make) {
            runner.result.note = "left out of this build: needs " + row.package;
        } else if (first_run(runner, scenes, {rules.threads, outcome.pairs}, rules)) {
            if (!known && row.group == Group::Clinch) {
                known = true;
                outcome.pairs = runner.result.pairs;
                mark = runner.result.mark;
                const std::uint64_t bytes = rows.size() * (300 * std::uint64_t{scenes[0].size()} + 24 * outcome.pairs);
                together = bytes <= rules.most_bytes;
            }
            runner.result.right = known && runner.result.pairs == outcome.pairs && runner.result.mark == mark;
            if (!together) runner.worker.reset();
        }
        runners.push_back(std::move(runner));
    }
    return runners;
}

}  // namespace

double Result::median_ms() const {
    return median(ms);
}

Outcome measure(const SceneName& scene, const std::vector<PeerRow>& rows, const Rules& rules) {
    Outcome outcome;
    outcome.scene = scene;
    const Scenes scenes{scenes::make_boxes(scene.kind, scene.count, scene.seed),
                        scenes::make_boxes(scene.kind, scene.count, scene.seed + 1000003)};
    bool together = false;
    std::vector<Runner> runners = first_runs(outcome, scenes, rows, rules, together);
    for (unsigned round = 0; round < rules.rounds; ++round) {
        const double most_ms = rules.hopeless * fastest_ms(runners);
        for (Runner& runner : runners) {
            if (most_ms > 0.0 && least_ms(runner.result) > most_ms) continue;
            if (round >= runner.rounds || !runner.result.note.empty()) continue;
            if (!runner.worker && !warm_up(runner, scenes, {rules.threads, outcome.pairs}, rules)) continue;
            next_run(runner, rules);
            if (!together) runner.worker.reset();
        }
    }
    for (Runner& runner : runners) outcome.results.push_back(std::move(runner.result));
    return outcome;
}

}  // namespace clinch::peers
