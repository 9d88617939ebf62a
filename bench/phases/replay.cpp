#include "bench/phases/replay.hpp"

#include <algorithm>
#include <utility>

namespace clinch::phases {
namespace {

constexpr double close = 1.1;   // times the best
constexpr double noise = 0.05;  // of what is measured of a step
constexpr std::size_t around = 2;

machines::Stream stream_of(unsigned units) {
    machines::Stream how;
    how.chunks = units;
    return how;
}

double median_around(const std::vector<machines::PhaseLoad>& loads, std::size_t i, double machines::PhaseLoad::*phase) {
    std::vector<double> window;
    for (std::size_t k = i - std::min(i, around); k < std::min(i + around + 1, loads.size()); ++k)
        window.push_back(loads[k].*phase);
    const auto middle = window.begin() + static_cast<std::ptrdiff_t>(window.size() / 2);
    std::nth_element(window.begin(), middle, window.end());
    return *middle;
}

std::size_t near_best(const machines::Balanced& run) {
    std::size_t near = 0;
    for (std::size_t i = 0; i < run.seconds.size(); ++i)
        if (run.seconds[i] <= close * run.best[i]) ++near;
    return near;
}

}  // namespace

std::vector<machines::PhaseLoad> smoothed(const std::vector<machines::PhaseLoad>& loads) {
    std::vector<machines::PhaseLoad> smooth;
    smooth.reserve(loads.size());
    for (std::size_t i = 0; i < loads.size(); ++i)
        smooth.push_back({median_around(loads, i, &machines::PhaseLoad::broad),
                          median_around(loads, i, &machines::PhaseLoad::narrow)});
    return smooth;
}

std::vector<std::string> assumptions() {
    return {
        "the work of each phase in each frame: as measured on one core, the median of five frames around it",
        "measured times of a step are off by up to 5 %, either way; unsmoothed: not off, the loads have their noise",
        "a chunk a unit, each of as much work; the units of a phase share each chunk evenly",
        "the buffer between the phases holds 4 chunks; a phase waits while it is empty or full",
        "20 us a chunk for each phase that no number of units shortens",
        "no unit helps the other phase; what is neither phase's work (making boxes) is left out",
        "the split of a step comes from the times of the steps before, each measured; a move costs nothing"};
}

std::vector<Replay> replay(const std::vector<machines::PhaseLoad>& loads, std::uint64_t seed) {
    const std::vector<machines::PhaseLoad> smooth = smoothed(loads);
    constexpr auto every = machines::Measured::EveryStep;  // as the library does
    std::vector<Replay> replays;
    for (const unsigned units : {4u, 8u, 16u}) {
        const machines::Stream how = stream_of(units);
        Replay run{units, machines::balance(smooth, how, units, noise, seed, every), {}, 0, 0};
        for (unsigned broad = 1; broad < units; ++broad) {
            std::vector<double>& seconds = run.fixed.emplace_back();
            for (const machines::PhaseLoad& load : smooth)
                seconds.push_back(machines::stream(load, how, broad, units).seconds);
        }
        run.near_best = near_best(run.balanced);
        run.near_best_unsmoothed = near_best(machines::balance(loads, how, units, 0.0, seed, every));
        replays.push_back(std::move(run));
    }
    return replays;
}

}  // namespace clinch::phases
