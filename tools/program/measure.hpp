// Running a step once to warm up and some times to be timed.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "clinch/aabb.hpp"
#include "clinch/contact.hpp"
#include "clinch/narrow_phase.hpp"
#include "clinch/report.hpp"
#include "clinch/view.hpp"

namespace clinch::program {

/// What a run of the step gave; pairs and contacts are valid until the next one.
struct StepOutcome {
    View<const Pair> pairs;
    Report report;
    View<const Contact> contacts{};
    std::optional<NarrowReport> narrow{};  ///< if there was a narrow phase
};

struct Measured {
    StepOutcome last;
    StageTimes median;      ///< of each stage by itself, over the timed runs
    NarrowTimes narrow;     ///< the same of the narrow phase, if there was one
    double first_ms = 0.0;  ///< the warming run, kernels built included
};

/// Runs step(0) to warm up, then step(1) ... step(repeat); with `repeat` 0 the first alone, which then stands
/// for the median too.
Measured measure(std::uint64_t repeat, const std::function<StepOutcome(std::uint64_t run)>& step);

}  // namespace clinch::program
