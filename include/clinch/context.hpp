// The set of devices that all work runs on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "clinch/device.hpp"

namespace clinch {

struct ContextOptions {
    /// Devices to use. The environment variable CLINCH_DEVICES (the same text as
    /// DeviceFilter::parse) narrows the choice further.
    DeviceFilter devices;
    /// Folder of compiled kernels. Empty: `clinch` in the user's cache folder (XDG_CACHE_HOME, or
    /// ~/.cache); with neither, nothing is kept.
    std::string kernel_cache;
    /// Keep compiled kernels on disk between runs.
    bool use_kernel_cache = true;
    /// Called with one line for each thing worth knowing that is no error (a damaged cache entry,
    /// a quirk, a device that failed). Called during calls of the library, on whatever thread works on a device, but
    /// never twice at once. The library itself prints nothing.
    std::function<void(const std::string&)> log;
};

/// What has been done on one device of a Context so far.
struct DeviceReport {
    DeviceInfo info;
    bool opened = false;                      ///< an OpenCL context and queue exist for it
    std::vector<std::string> modules_built;   ///< kernel modules compiled from source, in order
    std::vector<std::string> modules_cached;  ///< kernel modules read from the cache on disk
    double build_ms = 0.0;                    ///< milliseconds spent compiling or reading kernels
    std::uint64_t bytes = 0;                  ///< device memory held now
    std::uint64_t peak_bytes = 0;             ///< the most that was held at once
};

/// Devices, their kernel caches and memory; no state is kept outside of it. A device is opened (an
/// OpenCL context made) at its first use, a kernel module built at its first launch.
/// Movable; must outlive every BroadPhase and Pipeline made on it. One thread at a time may use a
/// Context and what was made on it; several Contexts work side by side.
class Context {
public:
    /// Finds the devices. None that passes the filter is Error NoDevice, which says which
    /// platforms were looked at and how to install an OpenCL driver for a CPU.
    explicit Context(const ContextOptions& options = {});
    /// A Context without devices, on which only host algorithms run. Looks for nothing.
    static Context host_only();
    ~Context();
    Context(Context&& other) noexcept;
    Context& operator=(Context&& other) noexcept;

    /// The chosen devices, in the order of list_devices().
    const std::vector<DeviceInfo>& devices() const noexcept;
    /// What was done on each of them, same order.
    std::vector<DeviceReport> report() const;
    /// Kernel modules that exist in all; those not in report() were not needed.
    std::size_t module_count() const noexcept;

    /// The library's own view of this context; not for users.
    struct Impl;
    explicit Context(std::unique_ptr<Impl> impl) noexcept;
    Impl& impl() const noexcept { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace clinch
