// The statistics file.
#pragma once

#include <string>
#include <vector>

#include "clinch/context.hpp"
#include "tools/program/measure.hpp"

namespace clinch::program {

/// What the statistics tell beyond what was measured.
struct StatsInput {
    std::vector<Rejection> rejected;
    double read_ms = 0.0;  ///< reading the input
};

/// The JSON text, ended by a line end. Times in milliseconds, memory in bytes.
std::string stats_text(const Measured& measured, const Context& context, const StatsInput& input);

}  // namespace clinch::program
