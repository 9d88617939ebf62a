// Faults of drivers that the library works around, each a function that says on which device it
// holds, what goes wrong and what is done instead. Nothing else in the library asks for a driver's name.
#pragma once

#include <string>
#include <vector>

#include "clinch/device.hpp"

namespace clinch::detail {

/// Names of the quirks that hold on a device.
std::vector<std::string> quirks_of(const DeviceInfo& info);

}  // namespace clinch::detail
