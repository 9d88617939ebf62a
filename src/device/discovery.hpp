// Every OpenCL device of the machine, and the choice among them.
#pragma once

#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

#include <memory>
#include <string>
#include <vector>

#include "clinch/device.hpp"

namespace clinch::detail {

/// A device with the handle that works on it. `owner` keeps the handle of a sub-device alive.
struct FoundDevice {
    DeviceInfo info;
    cl_device_id id = nullptr;
    std::shared_ptr<const void> owner;
};

/// All devices; `platforms` (if not null) receives the names of all platforms, those without devices too.
std::vector<FoundDevice> find_devices(std::vector<std::string>* platforms = nullptr);

/// What the device says of itself.
DeviceInfo describe(cl_device_id id);

/// The devices that pass `filter` and CLINCH_DEVICES, CPUs divided if asked for. None is Error NoDevice.
std::vector<FoundDevice> choose_devices(const DeviceFilter& filter);

/// How to install a driver for a CPU; ends the message of NoDevice.
extern const char* const install_hint;

}  // namespace clinch::detail
