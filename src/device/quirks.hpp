// Faults of drivers that the library works around, each a function that says on which device it
// holds, what goes wrong and what is done instead. Nothing else in the library asks for a driver's name.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clinch/device.hpp"

namespace clinch::detail {

/// llvmpipe (seen in Mesa 22.3) leaves a loop, without a word, once it and the loops inside it have run 65,535 times
/// together, and goes on behind it; tests/device/quirks_test.cpp holds the smallest kernel that shows it. A
/// work-item must stay below this number; what cannot is an error on such a device.
/// Returns how often a loop may run; 2^32 - 1 where there is no such fault.
std::uint32_t most_loop_iterations(const DeviceInfo& info);

/// Names of the quirks that hold on a device.
std::vector<std::string> quirks_of(const DeviceInfo& info);

}  // namespace clinch::detail
