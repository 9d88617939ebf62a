// What stands behind clinch::Context: the chosen devices, opened one by one when first used.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "clinch/context.hpp"
#include "src/device/device.hpp"

namespace clinch {

struct Context::Impl {
    ContextOptions options;
    std::vector<DeviceInfo> infos;
    std::vector<cl_device_id> ids;                         // retained: see DeviceList in discovery.hpp
    std::vector<std::shared_ptr<const void>> id_owners;    // keeps sub-devices alive
    std::vector<std::unique_ptr<detail::Device>> devices;  // null until opened
    /// For tests, to be set before a device is opened: as detail::FaultHook, with the number of the device whose call
    /// it is. Devices may be worked on by a thread each; the test sees to it that the hook bears that.
    std::function<cl_int(std::size_t device, const char* call)> fault_hook;

    /// For tests and benchmarks, as the hook: device i takes so many times as long as it does (see detail::Slowdown).
    std::vector<double> slowed;

    /// A broad phase of fewer boxes than this for each device goes to fewer devices.
    std::uint64_t least_boxes_a_device = 50000;
    std::vector<std::string> retired;  // why device i is not used any more; empty: it is

    /// Opens device i if it is not open yet.
    detail::Device& open(std::size_t i);
    /// The device that one-device work goes to: the first GPU, else the device with most compute
    /// units, of those not retired. Opens nothing. InvalidArgument on a Context without devices.
    std::size_t primary() const;
    /// Takes device i out of use, for good, and logs why. False if it is the last: then it stays.
    bool retire(std::size_t i, const std::string& why);
    /// One line on a device that was retired.
    std::string why_retired(std::size_t i) const;
    bool in_use(std::size_t i) const noexcept { return i >= retired.size() || retired[i].empty(); }
    /// Those not retired, the primary first, then as in infos.
    std::vector<std::size_t> crew() const;
};

}  // namespace clinch
