#include "src/device/quirks.hpp"

#include <limits>

namespace clinch::detail {

std::uint32_t most_loop_iterations(const DeviceInfo& info) {
    return info.name.find("llvmpipe") != std::string::npos ? 65535 : std::numeric_limits<std::uint32_t>::max();
}

std::vector<std::string> quirks_of(const DeviceInfo& info) {
    std::vector<std::string> quirks;
    if (most_loop_iterations(info) != std::numeric_limits<std::uint32_t>::max()) quirks.emplace_back("loops-end-early");
    return quirks;
}

}  // namespace clinch::detail
