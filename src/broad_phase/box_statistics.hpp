// How large boxes are and where: read by algorithms that choose cells, axes or layers.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "src/broad_phase/inputs.hpp"
#include "src/device/device.hpp"

namespace clinch::detail {

/// Boxes of like width (longest side): half an octave.
struct WidthClass {
    std::uint32_t count;
    float widest;
};

struct BoxStatistics {
    std::uint32_t boxes = 0;         ///< that are boxes
    std::array<float, 3> low, high;  ///< of the min corners; meaningless when there is no box
    std::vector<WidthClass> widths;  ///< classes that have boxes, narrow to wide
};

/// Gathers statistics on a device in one pass; keeps its memory. Waits.
class StatisticsGatherer {
public:
    explicit StatisticsGatherer(Device& device) : device_(device) {}
    BoxStatistics gather(BoxInput& boxes);

private:
    Device& device_;
    Kernel kernel_;
    Buffer corners_, counts_, widest_;
};

}  // namespace clinch::detail
