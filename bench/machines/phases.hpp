// Broad and narrow phase at work at the same time in virtual time, the units split by the library's own PhaseBalance.
#pragma once

#include <cstdint>
#include <vector>

#include "src/schedule/phase_balance.hpp"

namespace clinch::machines {

/// One step's work in unit-seconds: what one unit needs for it.
struct PhaseLoad {
    double broad, narrow;
};

/// How it is streamed from the one phase to the other. Assumptions: chunks of as much work each, shared evenly by the
/// units of a phase, and a time to hand over that no number of units shortens.
struct Stream {
    std::uint32_t chunks = 64;
    std::uint32_t held = 4;          ///< chunks the buffer between the phases holds
    double seconds_a_chunk = 20e-6;  ///< for each phase (assumed: a launch and a read)
};

struct PhaseStep {
    double seconds = 0.0;
    detail::PhaseBalance::Times busy{};  ///< each phase at work, without waits
};

/// One step with a fixed split: a phase waits while the buffer is empty or full.
PhaseStep stream(const PhaseLoad& load, const Stream& how, unsigned broad_units, unsigned units);

/// A scene of bodies that fall, strike a third of the way through, pile up and come to rest: pairs become more,
/// contacts many and then cheap (assumed curves). `seconds`: unit-seconds of the broad phase at the begin.
std::vector<PhaseLoad> falling_scene(std::size_t steps, double seconds);

struct Balanced {
    std::vector<double> seconds, best;  ///< of each step: as balanced, and with that step's best split
    std::vector<unsigned> broad_units;  ///< of each step: the split that was chosen for it
    std::uint64_t moves = 0;
    std::size_t checks = 0;
};
enum class Measured { OnlyChecked, EveryStep };
/// All steps; measured times are off by `noise` at most, either way.
Balanced balance(const std::vector<PhaseLoad>& scene, const Stream& how, unsigned units, double noise,
                 std::uint64_t seed, Measured measured = Measured::OnlyChecked);

}  // namespace clinch::machines
