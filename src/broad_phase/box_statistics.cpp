#include "src/broad_phase/box_statistics.hpp"

#include <algorithm>
#include <limits>

namespace clinch::detail {
namespace {

constexpr std::size_t classes = 512;  // CLASSES of the kernel

}  // namespace

BoxStatistics StatisticsGatherer::gather(BoxInput& boxes) {
    if (!kernel_) kernel_ = device_.kernel("broad_phase/box_statistics", "box_statistics");
    const DeviceInfo& info = device_.info();
    const std::uint32_t n = boxes.count();
    const std::uint32_t run_count = std::clamp(n / 1024, 1u, info.compute_units * (info.lanes > 1 ? 4u : 16u));
    const std::size_t runs = run_count;
    device_.reserve(corners_, runs * 6 * sizeof(float), "box statistics");
    device_.reserve(counts_, runs * classes * sizeof(std::uint32_t), "box statistics");
    device_.reserve(widest_, runs * classes * sizeof(float), "box statistics");
    const std::size_t group = device_.group_size();
    device_.launch(
        kernel_.args(boxes.on(device_), boxes.first(), n, n / run_count + 1, run_count, corners_, counts_, widest_),
        (runs + group - 1) / group, group);

    std::vector<float> corners(runs * 6), widest(runs * classes);
    std::vector<std::uint32_t> counts(runs * classes);
    device_.read(corners_, corners.data(), corners.size() * sizeof(float));
    device_.read(counts_, counts.data(), counts.size() * sizeof(std::uint32_t));
    device_.read(widest_, widest.data(), widest.size() * sizeof(float));

    BoxStatistics all;
    all.low.fill(std::numeric_limits<float>::infinity());
    all.high.fill(-std::numeric_limits<float>::infinity());
    for (std::size_t run = 0; run < runs; ++run)
        for (std::size_t d = 0; d < 3; ++d) {
            all.low[d] = std::min(all.low[d], corners[run * 6 + d]);
            all.high[d] = std::max(all.high[d], corners[run * 6 + 3 + d]);
        }
    for (std::size_t c = 0; c < classes; ++c) {
        WidthClass one{0, 0.0f};
        for (std::size_t run = 0; run < runs; ++run) {
            one.count += counts[run * classes + c];
            one.widest = std::max(one.widest, widest[run * classes + c]);
        }
        if (one.count > 0) all.widths.push_back(one);
        all.boxes += one.count;
    }
    return all;
}

}  // namespace clinch::detail
