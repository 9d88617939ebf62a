// Options that every command which runs a step has.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>

#include "clinch/broad_phase.hpp"
#include "clinch/device.hpp"
#include "clinch/narrow_phase.hpp"

namespace clinch::program {

/// As typed; read and checked by check_step_options.
struct StepTexts {
    std::string devices = "all";
    std::string algorithm = "auto";
    std::string precision = "0.5";
    std::string tolerance;
    std::string contacts_per_pair = "4";
    std::string order = "sorted";
    std::string repeat = "1";
    std::string seed = "0";
    std::string stats;
    bool strict = false;
};

/// What the texts mean.
struct StepOptions {
    DeviceFilter devices;
    std::string algorithm;
    bool host_only = false;  ///< the broad phase needs no device
    Order order = Order::Sorted;
    NarrowPhaseOptions narrow;
    std::uint64_t repeat = 1;
    std::string stats;  ///< empty: none asked for
    bool strict = false;
};

/// Adds the options to a subcommand, which has a narrow phase if `narrow`; `texts` must outlive the parsing.
void add_step_options(CLI::App& command, StepTexts& texts, bool narrow);

/// Reads and checks all of them, also those that matter to the narrow phase alone. Throws io::InputError or
/// Error InvalidArgument, which names the option, what was found and what is accepted.
StepOptions check_step_options(const StepTexts& texts, bool narrow);

}  // namespace clinch::program
