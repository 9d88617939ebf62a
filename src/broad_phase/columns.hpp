// Boxes as columns on a device, the form that streaming kernels read.
#pragma once

#include <cstdint>

#include "src/broad_phase/inputs.hpp"
#include "src/device/device.hpp"

namespace clinch::detail {

/// Six columns (min x, y, z, max x, y, z) of `stride` floats. Boxes that are no boxes, and the padding,
/// are NaN. Keeps its memory.
class BoxColumns {
public:
    explicit BoxColumns(Device& device) : device_(device) {}

    /// Enqueues the change of form. Columns are padded to a multiple of `block`.
    void make(BoxInput& boxes, std::uint32_t block);
    const Buffer& buffer() const noexcept { return columns_; }
    std::uint32_t stride() const noexcept { return stride_; }
    /// Whether the last boxes held one that is no box; waits.
    bool any_invalid();

private:
    Device& device_;
    Kernel kernel_;
    Buffer columns_, invalid_;
    std::uint32_t stride_ = 0;
};

}  // namespace clinch::detail
