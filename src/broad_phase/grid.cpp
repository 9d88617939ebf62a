// grid: boxes binned by their min corner [thesis 4.2.6]. See cl/broad_phase/grid.cl.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "src/broad_phase/algorithm.hpp"
#include "src/broad_phase/box_statistics.hpp"
#include "src/broad_phase/pair_sink.hpp"
#include "src/primitives/radix_sort.hpp"

namespace clinch::detail {
namespace {

// As the struct of the same name in grid.cl.
struct GridFrame {
    float origin[3];
    float scale[3];
    std::uint32_t size[3];
    std::uint32_t wrap[3];
    std::uint32_t cells;
    float widest;
    float reach;
};
static_assert(sizeof(GridFrame) == 60, "kernels read this layout");

constexpr std::uint32_t padding = 64;         // entries behind the last that vector loads may touch
constexpr std::uint32_t entries_a_task = 16;  // ENTRIES of grid_small
constexpr std::uint32_t parts = 8;            // PARTS of grid_large

unsigned bits_of(std::uint64_t value) {
    unsigned bits = 0;
    for (; value != 0; value >>= 1) ++bits;
    return bits;
}

// What is chosen from the statistics: which boxes are small, and the side of a cell.
struct Choice {
    float widest = 0.0f;
    double side = 1.0;
    std::uint32_t small = 0;
};

// Work of a choice in box tests, taking the small boxes as spread evenly: what a box looks through, and a
// price for each row of cells it visits.
double cost_of(const BoxStatistics& stats, std::size_t small_classes, double side, const double* extent) {
    constexpr double row_price = 12.0, large_price = 200.0;
    const double widest = static_cast<double>(stats.widths[small_classes - 1].widest);
    double small = 0.0, looked = 0.0, rows = 0.0, giants = 0.0;
    for (std::size_t c = 0; c < small_classes; ++c) small += stats.widths[c].count;
    const double density = small / ((extent[0] + widest) * (extent[1] + widest) * (extent[2] + widest));
    for (std::size_t c = 0; c < stats.widths.size(); ++c) {
        const double width = static_cast<double>(stats.widths[c].widest), count = stats.widths[c].count;
        const bool is_small = c < small_classes;
        const auto cells = [&](double length, int d) { return std::min(length, extent[d] + side) / side + 1.0; };
        const double z = cells(is_small ? width : width + widest, 2), y = cells(width + widest, 1),
                     x = cells(width + widest, 0);
        looked += count * density * x * y * z * side * side * side;
        rows += count * z * y;
        if (!is_small) giants += count;
    }
    return looked / 4.0 + row_price * rows + large_price * giants + giants * giants / 16.0;
}

Choice choose(const BoxStatistics& stats) {
    double extent[3];
    for (std::size_t d = 0; d < 3; ++d)
        extent[d] = static_cast<double>(stats.high[d]) - static_cast<double>(stats.low[d]);
    Choice best;
    double lowest = 0.0;
    std::uint32_t small = 0;
    for (std::size_t classes = 1; classes <= stats.widths.size(); ++classes) {
        small += stats.widths[classes - 1].count;
        if (small < stats.boxes / 2) continue;
        const float widest = stats.widths[classes - 1].widest;
        // Boxes without any width still need cells: as many as there are boxes.
        const double room = std::cbrt((extent[0] + 1e-30) * (extent[1] + 1e-30) * (extent[2] + 1e-30) / stats.boxes);
        const double base = widest > 0.0f ? static_cast<double>(widest) : std::max(room, 1e-30);
        for (const double factor : {0.25, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 8.0, 16.0}) {
            const double cost = cost_of(stats, classes, base * factor, extent);
            if (best.small != 0 && cost >= lowest) continue;
            lowest = cost;
            best = {widest, base * factor, small};
        }
    }
    return best;
}

GridFrame make_frame(const BoxStatistics& stats, const Choice& choice) {
    GridFrame frame{};
    // Cell numbers are floats before they are integers: up to 2^24 on an axis they are all different.
    double side = choice.side;
    for (std::size_t d = 0; d < 3; ++d)
        side = std::max(side, (static_cast<double>(stats.high[d]) - static_cast<double>(stats.low[d])) / 16777216.0);
    double wanted[3];
    const double most = std::clamp(4.0 * choice.small, 4096.0, 1.0e8);
    for (std::size_t d = 0; d < 3; ++d) {
        frame.origin[d] = stats.low[d];
        frame.scale[d] = static_cast<float>(1.0 / side);
        wanted[d] = std::floor((static_cast<double>(stats.high[d]) - static_cast<double>(stats.low[d])) / side) + 2.0;
        frame.size[d] = static_cast<std::uint32_t>(wanted[d]);
    }
    const auto cells = [&] { return double{1} * frame.size[0] * frame.size[1] * frame.size[2]; };
    while (cells() > most) {
        const std::size_t d = static_cast<std::size_t>(std::max_element(frame.size, frame.size + 3) - frame.size);
        const std::uint32_t half = (frame.size[d] + 1) / 2;
        frame.size[d] = 1u << bits_of(half - 1);
        frame.wrap[d] = 1;
    }
    frame.cells = frame.size[0] * frame.size[1] * frame.size[2];
    frame.widest = choice.widest;
    // A box's max is at most its min plus its width, each rounded once: covered by 2^-20 of the width, since
    // rounding keeps order.
    frame.reach = choice.widest * (1.0f + 0x1p-20f);
    return frame;
}

class Grid : public BroadPhaseAlgorithm {
public:
    Grid(Device& device, const BroadPhaseOptions& options)
        : device_(device), options_(options), statistics_(device), sort_(device), sink_(device, options) {}

    void find(BoxInput& boxes, const FilterInput& filters, PairList& pairs, FindCounts& counts) override;

private:
    void bin(BoxInput& boxes, const GridFrame& frame);
    Kernel& search_kernel(const char* name, const FilterInput& filters);

    Device& device_;
    const BroadPhaseOptions& options_;
    StatisticsGatherer statistics_;
    RadixSort sort_;
    PairSink sink_;
    Kernel keys_kernel_, gather_kernel_, starts_kernel_;
    std::map<std::string, Kernel> search_kernels_;
    Buffer frame_, keys_, order_, columns_, start_;
    std::uint64_t stride_ = 0;
};

Kernel& Grid::search_kernel(const char* name, const FilterInput& filters) {
    const char* const defines = PairSink::defines(filters);
    Kernel& kernel = search_kernels_[name + std::string(defines)];
    if (!kernel) kernel = device_.kernel("broad_phase/grid", name, defines);
    return kernel;
}

// Sorts the boxes by cell and lays them out as columns.
void Grid::bin(BoxInput& boxes, const GridFrame& frame) {
    if (!keys_kernel_) {
        keys_kernel_ = device_.kernel("broad_phase/grid", "grid_keys");
        gather_kernel_ = device_.kernel("broad_phase/grid", "grid_gather");
        starts_kernel_ = device_.kernel("broad_phase/grid", "grid_starts");
    }
    const std::uint32_t n = boxes.count();
    stride_ = std::uint64_t{n} + padding;
    device_.reserve(frame_, sizeof frame, "the frame of a grid");
    device_.write(frame_, &frame, sizeof frame);
    device_.reserve(keys_, n * sizeof(std::uint32_t), "cells of boxes");
    device_.reserve(order_, n * sizeof(std::uint32_t), "the order of boxes");
    device_.reserve(columns_, stride_ * 6 * sizeof(float), "boxes as columns");
    device_.reserve(start_, (std::size_t{frame.cells} + 3) * sizeof(std::uint32_t), "the starts of cells");
    device_.launch_items(keys_kernel_.args(boxes.on(device_), boxes.first(), n, frame_, keys_), n);
    sort_.sort(keys_, order_, n, bits_of(std::uint64_t{frame.cells} + 1), true);
    device_.launch_items(
        gather_kernel_.args(boxes.on(device_), boxes.first(), order_, n, static_cast<std::uint32_t>(stride_), columns_),
        stride_);
    device_.launch_items(starts_kernel_.args(keys_, n, frame.cells, start_),
                         (std::size_t{frame.cells} + 3 + 255) / 256);
}

void Grid::find(BoxInput& boxes, const FilterInput& filters, PairList& pairs, FindCounts& counts) {
    const std::uint32_t n = boxes.count();
    if (n < 2) {
        counts.invalid_boxes = n == 1;  // one box is looked at on the host
        return;
    }
    const BoxStatistics stats = statistics_.gather(boxes);
    counts.invalid_boxes = stats.boxes < n;
    if (stats.boxes < 2) return;
    const Choice choice = choose(stats);
    const GridFrame frame = make_frame(stats, choice);
    bin(boxes, frame);

    std::vector<SinkLaunch> launches;
    Kernel& small = search_kernel("grid_small", filters);
    small.args(columns_, stride_, order_, start_, frame_);
    launches.push_back({&small, 5, (choice.small + entries_a_task - 1) / entries_a_task});
    if (const std::uint32_t large_count = stats.boxes - choice.small; large_count > 0) {
        Kernel& large = search_kernel("grid_large", filters);
        large.args(columns_, stride_, order_, start_, frame_);
        launches.push_back({&large, 5, large_count * parts});
        Kernel& giants = search_kernel("grid_giants", filters);
        giants.args(columns_, stride_, order_, start_, frame.cells);
        launches.push_back({&giants, 5, large_count - 1});
    }
    sink_.collect(launches, filters, n, pairs, counts);
}

}  // namespace

std::unique_ptr<BroadPhaseAlgorithm> make_grid(Device* device, const BroadPhaseOptions& options) {
    return std::make_unique<Grid>(*device, options);
}

}  // namespace clinch::detail
