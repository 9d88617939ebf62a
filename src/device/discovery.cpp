#include "src/device/discovery.hpp"

#include <algorithm>
#include <boost/compute/device.hpp>
#include <boost/compute/system.hpp>
#include <charconv>
#include <cstdlib>
#include <sstream>
#include <string_view>

#include "clinch/error.hpp"
#include "src/device/opencl_error.hpp"
#include "src/device/quirks.hpp"

namespace clinch {

const char* to_string(DeviceType type) noexcept {
    switch (type) {
        case DeviceType::Cpu:
            return "cpu";
        case DeviceType::Gpu:
            return "gpu";
        case DeviceType::Accelerator:
            return "accelerator";
        case DeviceType::Other:
            return "other";
    }
    return "other";
}

DeviceFilter DeviceFilter::parse(const std::string& text, const std::string& what) {
    DeviceFilter filter;
    if (text == "all") return filter;
    for (const DeviceType type : {DeviceType::Cpu, DeviceType::Gpu, DeviceType::Accelerator})
        if (text == to_string(type)) {
            filter.type = type;
            return filter;
        }
    std::istringstream list(text + ',');  // a trailing comma is then an empty item, and refused
    for (std::string item; std::getline(list, item, ',');) {
        std::uint32_t index = 0;
        const auto [end, error] = std::from_chars(item.data(), item.data() + item.size(), index);
        if (item.empty() || error != std::errc{} || end != item.data() + item.size())
            throw Error(ErrorCode::InvalidArgument,
                        what + " is '" + text +
                            "'; accepted are device indices such as 0,2, a type (cpu, gpu, accelerator), or all");
        filter.indices.push_back(index);
    }
    return filter;
}

std::vector<DeviceInfo> list_devices() {
    std::vector<DeviceInfo> infos;
    for (detail::FoundDevice& found : detail::find_devices()) infos.push_back(std::move(found.info));
    return infos;
}

namespace detail {
namespace {

namespace compute = boost::compute;

DeviceType type_of(cl_device_type type) {
    // A simulator may claim several types at once; the first that holds counts.
    if ((type & CL_DEVICE_TYPE_CPU) != 0) return DeviceType::Cpu;
    if ((type & CL_DEVICE_TYPE_GPU) != 0) return DeviceType::Gpu;
    if ((type & CL_DEVICE_TYPE_ACCELERATOR) != 0) return DeviceType::Accelerator;
    return DeviceType::Other;
}

// Floats a work-item handles at once: the vector width of a CPU's core. A GPU spreads work-items
// over its lanes by itself.
std::uint32_t lanes_of(DeviceType type, cl_uint native_width) {
    if (type != DeviceType::Cpu) return 1;
    for (const std::uint32_t lanes : {16u, 8u, 4u})
        if (native_width >= lanes) return lanes;
    return 1;
}

std::string use_of(const DeviceInfo& info) {
    const std::string precision = info.fp64 ? "" : ", float64 on the host";
    if (info.lanes > 1) return "all kernels, " + std::to_string(info.lanes) + " boxes at once on each core" + precision;
    return "all kernels, one box a work-item" + precision;
}

bool passes(const DeviceFilter& filter, const DeviceInfo& info) {
    const auto& wanted = filter.indices;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), info.index) == wanted.end()) return false;
    return !filter.type || *filter.type == info.type;
}

std::string describe(const DeviceFilter& filter) {
    if (filter.type) return to_string(*filter.type);
    if (filter.indices.empty()) return "all";
    std::string text;
    for (const std::uint32_t index : filter.indices) text += (text.empty() ? "" : ",") + std::to_string(index);
    return text;
}

[[noreturn]] void throw_none(const std::vector<std::string>& platforms, const std::vector<FoundDevice>& found,
                             const DeviceFilter& filter, const std::string& environment) {
    std::string looked = platforms.empty() ? "no OpenCL platform is installed" : "looked at the OpenCL platforms ";
    for (std::size_t i = 0; i < platforms.size(); ++i) looked += (i == 0 ? "'" : ", '") + platforms[i] + "'";
    if (found.empty())
        throw Error(ErrorCode::NoDevice, "no OpenCL device was found: " + looked +
                                             (platforms.empty() ? "" : ", which offer none") + "; " + install_hint);
    std::string asked = "devices '" + describe(filter) + "'";
    if (!environment.empty()) asked += " and CLINCH_DEVICES '" + environment + "'";
    throw Error(ErrorCode::NoDevice, "no OpenCL device passes " + asked + ": " + looked + ", which offer " +
                                         std::to_string(found.size()) + (found.size() == 1 ? " device" : " devices") +
                                         ", numbered from 0");
}

// Cuts a device into `parts` devices of equally many compute units.
void divide(const FoundDevice& whole, std::uint32_t parts, std::vector<FoundDevice>& out) {
    const std::uint32_t units = whole.info.compute_units / parts;
    if (units == 0)
        throw Error(ErrorCode::InvalidArgument, "cannot divide device " + std::to_string(whole.info.index) + " ('" +
                                                    whole.info.name + "') of " +
                                                    std::to_string(whole.info.compute_units) + " compute units into " +
                                                    std::to_string(parts) + " devices");
    // Some drivers crash when asked for what they say they do not have.
    const auto most = checked("clGetDeviceInfo on '" + whole.info.name + "'", [&] {
        return compute::device(whole.id).get_info<cl_uint>(CL_DEVICE_PARTITION_MAX_SUB_DEVICES);
    });
    if (most < parts)
        throw Error(ErrorCode::InvalidArgument, "cannot divide device " + std::to_string(whole.info.index) + " ('" +
                                                    whole.info.name + "'): its driver offers " +
                                                    (most == 0 ? "no" : "at most " + std::to_string(most)) +
                                                    " sub-devices");
    const auto owner =
        std::make_shared<std::vector<compute::device>>(checked("clCreateSubDevices on '" + whole.info.name + "'", [&] {
            return compute::device(whole.id).partition_by_counts(std::vector<std::size_t>(parts, units));
        }));
    for (std::uint32_t part = 0; part < parts; ++part) {
        FoundDevice found{whole.info, (*owner)[part].id(), owner};
        found.info.compute_units = units;
        found.info.sub_device = part;
        found.info.sub_devices = parts;
        out.push_back(std::move(found));
    }
}

}  // namespace

const char* const install_hint =
    "a CPU can be used through PoCL (Debian, Ubuntu: apt install pocl-opencl-icd; Fedora: dnf install pocl)";

DeviceInfo describe(cl_device_id id) {
    const compute::device device(id);
    DeviceInfo info;
    info.name = device.name();
    info.vendor = device.vendor();
    info.platform = device.platform().name();
    info.platform_version = device.platform().version();
    info.version = device.version();
    info.driver_version = device.driver_version();
    info.type = type_of(device.get_info<cl_device_type>(CL_DEVICE_TYPE));
    info.compute_units = device.compute_units();
    info.clock_mhz = device.clock_frequency();
    info.lanes = lanes_of(info.type, device.get_info<cl_uint>(CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT));
    info.global_memory = device.global_memory_size();
    info.max_allocation = device.max_memory_alloc_size();
    info.local_memory = device.local_memory_size();
    info.fp64 = device.supports_extension("cl_khr_fp64");
    info.exact_division =
        (device.get_info<cl_device_fp_config>(CL_DEVICE_SINGLE_FP_CONFIG) & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
    info.unified_memory = device.get_info<cl_bool>(CL_DEVICE_HOST_UNIFIED_MEMORY) != CL_FALSE;
    info.quirks = quirks_of(info);
    info.use = use_of(info);
    return info;
}

std::vector<FoundDevice> find_devices(std::vector<std::string>* platforms) {
    std::vector<FoundDevice> found;
    std::uint32_t index = 0;
    for (const compute::platform& platform : checked("clGetPlatformIDs", [] { return compute::system::platforms(); })) {
        try {
            if (platforms != nullptr) platforms->push_back(platform.name());
            for (const compute::device& device : platform.devices()) {
                FoundDevice one{describe(device.id()), device.id(), nullptr};
                one.info.index = index++;
                found.push_back(std::move(one));
            }
        } catch (const compute::opencl_error&) {
            continue;  // a driver that cannot describe its own devices has none to offer
        }
    }
    return found;
}

std::vector<FoundDevice> choose_devices(const DeviceFilter& filter) {
    std::vector<std::string> platforms;
    const std::vector<FoundDevice> found = find_devices(&platforms);
    const char* variable = std::getenv("CLINCH_DEVICES");
    const std::string environment = variable == nullptr ? "" : variable;
    const DeviceFilter narrowed =
        environment.empty() ? DeviceFilter{} : DeviceFilter::parse(environment, "CLINCH_DEVICES");
    std::vector<FoundDevice> chosen;
    for (const FoundDevice& one : found) {
        if (!passes(filter, one.info) || !passes(narrowed, one.info)) continue;
        if (filter.sub_devices > 1 && one.info.type == DeviceType::Cpu)
            divide(one, filter.sub_devices, chosen);
        else
            chosen.push_back(one);
    }
    if (chosen.empty()) throw_none(platforms, found, filter, environment);
    return chosen;
}

}  // namespace detail
}  // namespace clinch
