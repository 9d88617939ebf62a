#include "src/broad_phase/box_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "src/device/quirks.hpp"

namespace clinch::detail {
namespace {

constexpr std::size_t classes = 512;             // CLASSES of the kernel
constexpr std::size_t record = 6 + 2 * classes;  // RECORD of the kernel

// Boxes of the sample: enough to see a crowd, few enough to cost nothing beside the rest.
std::uint32_t sample_size(std::uint32_t boxes) {
    return std::clamp(boxes / 16, 256u, 4096u);
}

void add_record(const float* words, std::size_t samples, std::vector<WidthClass>& widths, BoxStatistics& all) {
    for (std::size_t d = 0; d < 3; ++d) {
        all.low[d] = std::min(all.low[d], words[d]);
        all.high[d] = std::max(all.high[d], words[3 + d]);
    }
    for (std::size_t c = 0; c < classes; ++c) {
        std::uint32_t count = 0;
        std::memcpy(&count, words + 6 + c, sizeof count);
        widths[c].count += count;
        widths[c].widest = std::max(widths[c].widest, words[6 + classes + c]);
    }
    for (const float* corner = words + record; corner < words + record + 3 * samples; corner += 3)
        if (!std::isnan(corner[0])) all.sample.push_back({corner[0], corner[1], corner[2]});
}

}  // namespace

BoxStatistics StatisticsGatherer::gather(BoxInput& boxes) {
    if (!kernel_) kernel_ = device_.kernel("broad_phase/box_statistics", "box_statistics");
    const DeviceInfo& info = device_.info();
    const std::uint32_t n = boxes.count();
    const std::uint32_t least = n / (most_loop_iterations(info) / 8) + 1;  // no run may be longer than a loop
    const std::uint32_t runs =
        std::max(least, std::clamp(n / 1024, 1u, info.compute_units * (info.lanes > 1 ? 4u : 16u)));
    const std::uint32_t samples = sample_size(n) / runs + 1;
    const std::size_t words = record + std::size_t{3} * samples;
    device_.reserve(records_, runs * words * sizeof(float), "box statistics");
    const std::size_t group = device_.group_size();
    device_.launch(kernel_.args(boxes.on(device_), boxes.first(), n, n / runs + 1, runs, samples, records_),
                   (runs + group - 1) / group, group);
    std::vector<float> records(runs * words);
    device_.read(records_, records.data(), records.size() * sizeof(float));

    BoxStatistics all;
    all.low.fill(std::numeric_limits<float>::infinity());
    all.high.fill(-std::numeric_limits<float>::infinity());
    std::vector<WidthClass> widths(classes, {0, 0.0f});
    for (std::size_t run = 0; run < runs; ++run) add_record(records.data() + run * words, samples, widths, all);
    for (const WidthClass& one : widths) {
        if (one.count > 0) all.widths.push_back(one);
        all.boxes += one.count;
    }
    return all;
}

double BoxStatistics::crowding(double distance) const {
    constexpr std::uint64_t fewest_pairs = 16;  // fewer tell nothing
    if (!(distance > 0.0) || sample.size() < 2) return 1.0;
    std::vector<std::uint64_t> cells;
    cells.reserve(sample.size());
    double even = 1.0;  // chance that two boxes share a cell if they are spread evenly
    for (std::size_t d = 0; d < 3; ++d) even *= distance / std::max(extent(d), distance);
    for (const std::array<float, 3>& corner : sample) {
        std::uint64_t cell = 0;
        for (std::size_t d = 0; d < 3; ++d) {
            const double at = std::floor((static_cast<double>(corner[d]) - static_cast<double>(low[d])) / distance);
            cell = (cell ^ static_cast<std::uint64_t>(std::min(at, 1e18))) * 0x9e3779b97f4a7c15u;
            cell ^= cell >> 29;
        }
        cells.push_back(cell);
    }
    std::sort(cells.begin(), cells.end());
    std::uint64_t together = 0;
    for (std::size_t first = 0, end = 0; first < cells.size(); first = end) {
        while (end < cells.size() && cells[end] == cells[first]) ++end;
        together += std::uint64_t{end - first} * (end - first - 1) / 2;
    }
    if (together < fewest_pairs) return 1.0;
    const double all = 0.5 * static_cast<double>(cells.size()) * static_cast<double>(cells.size() - 1);
    return std::max(1.0, static_cast<double>(together) / (all * even));
}

}  // namespace clinch::detail
