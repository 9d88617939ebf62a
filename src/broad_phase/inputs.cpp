#include "src/broad_phase/inputs.hpp"

#include <array>

namespace clinch::detail {

BoxInput::BoxInput(View<const Aabb> boxes, Buffer& staging)
    : host_(boxes), staging_(&staging), count_(static_cast<std::uint32_t>(boxes.size())) {}

BoxInput::BoxInput(Device& device, cl_mem boxes, std::uint64_t first, std::uint32_t count)
    : device_(&device), memory_(boxes), first_(first), count_(count) {}

View<const Aabb> BoxInput::on_host() {
    if (host_.data() == nullptr && count_ != 0) {
        read_back_.resize(count_);
        device_->read(memory_, read_back_.data(), count_ * sizeof(Aabb), first_ * sizeof(Aabb));
        host_ = read_back_;
    }
    return host_;
}

cl_mem BoxInput::on(Device& device) {
    if (device_ != &device) {
        const View<const Aabb> boxes = on_host();
        Buffer& staging = staging_ != nullptr ? *staging_ : own_;
        device.reserve(staging, boxes.size() * sizeof(Aabb), "boxes");
        device.write(staging, boxes.data(), boxes.size() * sizeof(Aabb));
        device_ = &device;
        memory_ = staging.handle();
        first_ = 0;
    }
    return memory_;
}

const Buffer& FilterMirror::on_device(const FilterInput& filters, std::uint32_t count) {
    if (filters.version != 0 && filters.version == version_ && count == count_) return buffer_;
    std::vector<std::array<std::uint32_t, 4>> rows(count);
    for (std::uint32_t i = 0; i < count; ++i)
        rows[i] = {filters.group(i), filters.mask(i), filters.can_move(i) ? 1u : 0u, 0u};
    version_ = 0;  // until the new ones are there
    device_.reserve(buffer_, rows.size() * sizeof rows[0], "filters");
    device_.write(buffer_, rows.data(), rows.size() * sizeof rows[0]);
    version_ = filters.version;
    count_ = count;
    return buffer_;
}

}  // namespace clinch::detail
