#include "src/device/quirks.hpp"

namespace clinch::detail {

std::vector<std::string> quirks_of(const DeviceInfo&) {
    return {};
}

}  // namespace clinch::detail
