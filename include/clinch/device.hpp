// OpenCL devices as the library sees them, and how to choose among them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace clinch {

enum class DeviceType { Cpu, Gpu, Accelerator, Other };

/// "cpu", "gpu", "accelerator" or "other". The string is static.
const char* to_string(DeviceType type) noexcept;

/// What one OpenCL device is, as its driver says. Sizes are in bytes.
struct DeviceInfo {
    std::uint32_t index = 0;  ///< its place in list_devices(): platforms in loader order, devices within
    std::string name;
    std::string vendor;
    std::string platform;
    std::string platform_version;
    std::string version;  ///< the OpenCL version it implements
    std::string driver_version;
    DeviceType type = DeviceType::Other;
    std::uint32_t compute_units = 0;
    std::uint32_t clock_mhz = 0;
    std::uint32_t lanes = 1;  ///< floats a work-item of a lane-generic kernel handles at once here
    std::uint64_t global_memory = 0;
    std::uint64_t max_allocation = 0;
    std::uint64_t local_memory = 0;
    bool fp64 = false;                ///< computes in float64
    bool exact_division = false;      ///< rounds float32 division and square root correctly when asked to
    bool unified_memory = false;      ///< shares the host's memory: results are mapped, not copied
    std::uint32_t sub_device = 0;     ///< which part of the device this is; 0 if `sub_devices` is 1
    std::uint32_t sub_devices = 1;    ///< how many equal parts the device was divided into
    std::vector<std::string> quirks;  ///< names of the driver faults that the library works around here
    std::string use;                  ///< what the library would use it for, one clause
};

/// Which devices to use. All conditions must hold; a default one lets every device pass.
struct DeviceFilter {
    std::vector<std::uint32_t> indices;  ///< as in DeviceInfo::index; empty: any
    std::optional<DeviceType> type;
    /// Divide each CPU device that passes into this many parts of equally many compute units, each
    /// a device of its own (0 or 1: leave whole). Asking for more parts than units is InvalidArgument.
    std::uint32_t sub_devices = 0;

    /// Reads "all", a type ("cpu", "gpu", "accelerator"), or indices ("0,2").
    /// Anything else is InvalidArgument with `what` (an option's or variable's name) in the message.
    static DeviceFilter parse(const std::string& text, const std::string& what);
};

/// Every device of every platform, none filtered out. Creates no context. No platform or device at
/// all gives an empty list. Devices that the driver itself cannot describe are left out.
std::vector<DeviceInfo> list_devices();

}  // namespace clinch
