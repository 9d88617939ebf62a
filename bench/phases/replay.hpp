// Measured work of the phases, replayed on simulated machines of more units, which PhaseBalance splits between them
// [thesis 6.1.2].
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/machines/phases.hpp"

namespace clinch::phases {

/// One scene on one number of units.
struct Replay {
    unsigned units;
    machines::Balanced balanced;
    std::vector<std::vector<double>> fixed;  ///< seconds of each step with 1, 2, ... units for the broad phase
    std::size_t near_best;                   ///< steps within 10 % of the best fixed split of that step
    std::size_t near_best_unsmoothed;        ///< the same of the loads as measured
};

/// Each the median of the five around it (at the ends fewer): bursts of one frame are the machine's, not the scene's,
/// and nothing could split for them beforehand.
std::vector<machines::PhaseLoad> smoothed(const std::vector<machines::PhaseLoad>& loads);

/// What the replays assume.
std::vector<std::string> assumptions();

/// Replays them, smoothed, on 4, 8 and 16 units.
std::vector<Replay> replay(const std::vector<machines::PhaseLoad>& loads, std::uint64_t seed);

}  // namespace clinch::phases
