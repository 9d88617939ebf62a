// A machine simulated in virtual time, whose work is shared by the library's own classes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bench/machines/machine.hpp"
#include "bench/scenes/random.hpp"
#include "src/schedule/clock.hpp"
#include "src/schedule/shares.hpp"

namespace clinch::machines {

/// Shows the time it was set to.
class VirtualClock final : public detail::Clock {
public:
    double now() const override { return now_; }
    void set(double seconds) { now_ = seconds; }

private:
    double now_ = 0.0;
};

/// What happened in one step.
struct Step {
    struct Of {
        std::uint32_t taken = 0, stolen = 0;  ///< chunks whose results arrived, and those of them dealt to others
        double seconds = 0.0;                 ///< from the step's begin until its last result was on the host
    };
    double seconds = 0.0;     ///< until all results were in order on the host
    std::uint32_t left = 0;   ///< chunks nobody did: all devices have failed
    double stolen = 0.0;      ///< part of the chunks
    std::vector<Of> devices;  ///< as in the machine
};

/// Steps on one machine, one after the other: shares from the steps before, chunks dealt and stolen. The same for the
/// same seed. Cost of a step: chunks * log(devices), and a step for each device and theft.
class Simulation {
public:
    Simulation(Machine machine, std::uint64_t seed);
    Step step(const Load& load);
    /// Virtual seconds of all steps so far.
    const detail::Clock& clock() const { return clock_; }
    const detail::Shares& shares() const { return shares_; }

private:
    Machine machine_;
    VirtualClock clock_;
    detail::Shares shares_;
    scenes::Random random_;
};

/// The last of `steps` steps of the same work.
Step settled(const Machine& machine, const Load& load, int steps, std::uint64_t seed);

}  // namespace clinch::machines
