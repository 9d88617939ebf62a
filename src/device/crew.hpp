// The devices of a Context at work side by side: one host thread each [thesis 5.1].
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "clinch/device.hpp"

namespace clinch::detail {

/// Runs `work(k)` for each k below `count` at once, each in a host thread of its own (k = 0 in the caller's), and waits
/// for all. Threads are sure to run side by side, so that they may wait for each other, as those of a parallel loop are
/// not. Returns what each threw, null where nothing was. Where no thread is to be had for one, that throws Error
/// (DeviceFailed), after `without(k)` was called in the caller's thread, before its own work begins.
std::vector<std::exception_ptr> run_crew(std::size_t count, const std::function<void(std::size_t)>& work,
                                         const std::function<void(std::size_t)>& without = {});

/// Whether a device gave up, so that another one may do its work: an OpenCL call failed (that of a build, too) or
/// memory was short there. All else is the fault of what was asked for.
bool is_device_fault(const std::exception_ptr& thrown);

/// What a device threw that gave up, with its place in the context: thrown where more than one may have.
struct DeviceFault {
    std::size_t device;
    std::exception_ptr why;
};

/// Of a DeviceFault why, else what was thrown.
std::exception_ptr cause_of(const std::exception_ptr& thrown);

/// How fast a device may be beside others, while nothing was measured.
double guessed_speed(const DeviceInfo& device) noexcept;

/// The message of an exception.
std::string message_of(const std::exception_ptr& thrown);

}  // namespace clinch::detail
