#include "bench/phases/replay.hpp"

namespace clinch::phases {

namespace {

constexpr double near = 1.1;  // times the best
constexpr std::uint32_t chunks_a_unit = 4;

machines::Stream stream_of(unsigned units) {
    machines::Stream how;
    how.chunks = chunks_a_unit * units;
    return how;
}

}  // namespace

std::vector<std::string> assumptions() {
    return {"the work of each phase in each frame: as measured on one core, noise of the measurement included",
            "4 chunks a unit of as much work each; the units of a phase share each chunk evenly",
            "the buffer between the phases holds 4 chunks; a phase waits while it is empty or full",
            "20 us a chunk for each phase that no number of units shortens",
            "no unit helps the other phase; what is neither phase's work (making boxes) is left out",
            "the split of a step comes from the times of the steps before, each measured; a move costs nothing"};
}

std::vector<Replay> replay(const std::vector<machines::PhaseLoad>& loads, std::uint64_t seed) {
    std::vector<Replay> replays;
    for (const unsigned units : {4u, 8u, 16u}) {
        const machines::Stream how = stream_of(units);
        Replay run{units, machines::balance(loads, how, units, 0.0, seed, machines::Measured::EveryStep), {}, 0};
        for (unsigned broad = 1; broad < units; ++broad) {
            std::vector<double>& seconds = run.fixed.emplace_back();
            for (const machines::PhaseLoad& load : loads)
                seconds.push_back(machines::stream(load, how, broad, units).seconds);
        }
        for (std::size_t i = 0; i < loads.size(); ++i)
            if (run.balanced.seconds[i] <= near * run.balanced.best[i]) ++run.near_best;
        replays.push_back(run);
    }
    return replays;
}

}  // namespace clinch::phases
