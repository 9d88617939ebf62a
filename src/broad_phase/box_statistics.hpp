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
    std::uint32_t boxes = 0;                   ///< that are boxes
    std::array<float, 3> low, high;            ///< of the min corners; meaningless when there is no box
    std::vector<WidthClass> widths;            ///< classes that have boxes, narrow to wide
    std::vector<std::array<float, 3>> sample;  ///< min corners of boxes taken evenly from all

    /// Length from low to high on an axis.
    double extent(std::size_t d) const { return static_cast<double>(high[d]) - static_cast<double>(low[d]); }
    /// How many times as many boxes a box has within `distance` of it as if all were spread evenly: 1 for an even
    /// spread, more where they crowd. From the sample: pairs of it that share a cell of that side.
    double crowding(double distance) const;
};

/// Gathers statistics on a device in one pass; keeps its memory. Waits.
class StatisticsGatherer {
public:
    explicit StatisticsGatherer(Device& device) : device_(device) {}
    BoxStatistics gather(BoxInput& boxes);

private:
    Device& device_;
    Kernel kernel_;
    Buffer records_;
};

}  // namespace clinch::detail
