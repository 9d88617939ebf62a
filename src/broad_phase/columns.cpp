#include "src/broad_phase/columns.hpp"

#include <limits>

namespace clinch::detail {

void BoxColumns::make(BoxInput& boxes, std::uint32_t block) {
    if (!kernel_) {  // made last
        invalid_ = device_.allocate(sizeof(std::uint32_t), "a flag");
        kernel_ = device_.kernel("broad_phase/columns", "columns");
    }
    const std::uint64_t padded = (std::uint64_t{boxes.count()} + block - 1) / block * block;
    if (padded > std::numeric_limits<std::uint32_t>::max())
        throw Error(ErrorCode::OutOfMemory,
                    std::to_string(boxes.count()) + " boxes are more than one device can hold as columns");
    stride_ = static_cast<std::uint32_t>(padded);
    device_.reserve(columns_, padded * 6 * sizeof(float), "boxes as columns");
    device_.clear(invalid_, sizeof(std::uint32_t));
    kernel_.args(boxes.on(device_), boxes.first(), boxes.count(), stride_, columns_, invalid_,
                 LocalMemory{sizeof(std::uint32_t)});
    device_.launch_items(kernel_, stride_);
}

bool BoxColumns::any_invalid() {
    std::uint32_t flag = 0;
    device_.read(invalid_, &flag, sizeof flag);
    return flag != 0;
}

}  // namespace clinch::detail
