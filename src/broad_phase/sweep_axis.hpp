// The axis that boxes are sorted along.
#pragma once

#include <cstdint>

#include "src/broad_phase/inputs.hpp"
#include "src/device/device.hpp"

namespace clinch::detail {

struct AxisChoice {
    std::uint32_t axis = 0;   ///< 0, 1 or 2
    std::uint32_t boxes = 0;  ///< boxes that are boxes
};

/// Chooses the axis on which the centres vary most; where that is equal, or too large for float32, the longest extent
/// decides [Ericson, Real-Time Collision Detection, 7.5.2]. Keeps its memory.
class AxisChooser {
public:
    explicit AxisChooser(Device& device) : device_(device) {}
    /// One pass over the boxes on the device (sweep_statistics of cl/broad_phase/sweep.cl); waits.
    AxisChoice choose(BoxInput& boxes);

private:
    Device& device_;
    Kernel kernel_;
    Buffer records_;
};

}  // namespace clinch::detail
