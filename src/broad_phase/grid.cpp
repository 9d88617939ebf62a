#include "src/broad_phase/grid.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "src/primitives/bits.hpp"

namespace clinch::detail {
namespace {

constexpr std::uint32_t parts = 8;  // PARTS of grid_large

// What is chosen from the statistics: which boxes are small, and the sides of a cell.
struct Choice {
    float widest = 0.0f;
    double side_x = 1.0, side = 1.0;  // along x; along y and z
    std::uint32_t small = 0;
};

// Boxes are looked for together as long as they are within so many times what one looks through on x.
constexpr double span_windows = 6.0;

// What a choice costs, in tests of LANES boxes, taking the small boxes as spread evenly.
class CostModel {
public:
    // `crowding`: how many times denser than on average it is where a box is.
    CostModel(const BoxStatistics& stats, double lanes, double crowding)
        : stats_(stats), lanes_(lanes), crowding_(crowding) {
        for (std::size_t d = 0; d < 3; ++d) extent_[d] = stats.extent(d);
    }
    double of(std::size_t small_classes, const Choice& choice) const {
        const double widest = static_cast<double>(choice.widest);
        const double density =
            crowding_ * choice.small / ((extent_[0] + widest) * (extent_[1] + widest) * (extent_[2] + widest) + 1e-300);
        double cost = cells(choice) * cell_price + of_small(choice, density);
        double giants = 0.0;
        for (std::size_t c = small_classes; c < stats_.widths.size(); ++c) {
            const double count = stats_.widths[c].count;
            giants += count;
            cost += count * (large_price + of_large(choice, density, static_cast<double>(stats_.widths[c].widest)));
        }
        return cost + giants * giants / lanes_;
    }
    double cells(const Choice& choice) const {
        const double all =
            (extent_[0] / choice.side_x + 1.0) * (extent_[1] / choice.side + 1.0) * (extent_[2] / choice.side + 1.0);
        return std::min(all, 4.0 * choice.small);
    }

private:
    static constexpr double cell_price = 0.2, row_price = 6.0, group_price = 12.0, large_price = 100.0;

    // How far one looks on an axis: what is wanted and the cells that stick out, at most the whole grid.
    double reach(double wanted, double side, std::size_t d) const {
        return std::min(wanted + side, extent_[d] + 2.0 * side);
    }
    double of_small(const Choice& choice, double density) const {
        const double widest = static_cast<double>(choice.widest);
        const double a_row = density * choice.side * std::min(choice.side, extent_[2] + choice.side);
        const double window = 2.0 * widest + choice.side_x;
        const double members = std::clamp(a_row * window * span_windows, 1.0, lanes_);
        const double spread = (members - 1.0) / (members + 1.0) * choice.side;
        const double x = reach((members - 1.0) / (a_row + 1e-300) + 2.0 * widest, choice.side_x, 0),
                     y = reach(spread + 2.0 * widest, choice.side, 1), z = reach(spread + widest, choice.side, 2);
        const double rows = y * z / (choice.side * choice.side);
        return choice.small / members * (density * x * y * z + row_price * rows + group_price);
    }
    double of_large(const Choice& choice, double density, double width) const {
        const double widest = static_cast<double>(choice.widest);
        const double x = reach(width + widest, choice.side_x, 0), y = reach(width + widest, choice.side, 1),
                     z = reach(width + widest, choice.side, 2);
        return 1.5 * density * x * y * z / lanes_ + row_price * y * z / (choice.side * choice.side);
    }

    const BoxStatistics& stats_;
    double lanes_, crowding_;
    double extent_[3];
};

Choice best_choice(const BoxStatistics& stats, const CostModel& model) {
    Choice best;
    double lowest = 0.0;
    std::uint32_t small = 0;
    for (std::size_t classes = 1; classes <= stats.widths.size(); ++classes) {
        small += stats.widths[classes - 1].count;
        if (small < stats.boxes / 2) continue;
        const float widest = stats.widths[classes - 1].widest;
        // Boxes without any width still need cells: as many as there are boxes.
        const double room =
            std::cbrt((stats.extent(0) + 1e-30) * (stats.extent(1) + 1e-30) * (stats.extent(2) + 1e-30) / stats.boxes);
        const double base = widest > 0.0f ? static_cast<double>(widest) : std::max(room, 1e-30);
        for (const double factor : {0.25, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0, 8.0, 16.0})
            for (const double along_x : {0.35, 0.7, 1.4}) {
                const Choice choice{widest, base * factor * along_x, base * factor, small};
                const double cost = model.of(classes, choice);
                if (best.small != 0 && cost >= lowest) continue;
                lowest = cost;
                best = choice;
            }
    }
    return best;
}

Choice choose(const BoxStatistics& stats, double lanes) {
    const Choice even = best_choice(stats, CostModel(stats, lanes, 1.0));
    const double crowding = stats.crowding(4.0 * static_cast<double>(even.widest));
    return crowding > 1.5 ? best_choice(stats, CostModel(stats, lanes, crowding)) : even;
}

GridFrame make_frame(const BoxStatistics& stats, const Choice& choice) {
    GridFrame frame{};
    // Cell numbers are floats before they are integers: up to 2^24 on an axis they are all different.
    double sides[3] = {choice.side_x, choice.side, choice.side};
    for (std::size_t d = 0; d < 3; ++d) sides[d] = std::max(sides[d], stats.extent(d) / 16777216.0);
    const double most = std::clamp(4.0 * choice.small, 4096.0, 1.0e8);
    for (std::size_t d = 0; d < 3; ++d) {
        frame.origin[d] = stats.low[d];
        frame.scale[d] = static_cast<float>(1.0 / sides[d]);
        frame.size[d] = static_cast<std::uint32_t>(std::floor(stats.extent(d) / sides[d]) + 2.0);
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
    frame.span = static_cast<float>(span_windows * (2.0 * static_cast<double>(choice.widest) + sides[0]));
    frame.side = static_cast<float>(sides[1]);
    return frame;
}

}  // namespace

Kernel& Grid::search_kernel(const char* name, const FilterInput& filters) {
    const char* const defines = PairSink::defines(filters);
    Kernel& kernel = search_kernels_[name + std::string(defines)];
    if (!kernel)
        kernel =
            device_.kernel("broad_phase/grid", name, "-DENTRIES=" + std::to_string(entries_a_task()) + " " + defines);
    return kernel;
}

// A work-item of a CPU takes a few vectors of entries at once, of which it has only a few thousand to take.
std::uint32_t Grid::entries_a_task() const {
    return device_.info().lanes > 1 ? 8 * device_.info().lanes : 16;
}

// Sorts the boxes by cell and lays them out as columns.
void Grid::make_entries(BoxInput& boxes) {
    const GridFrame& frame = host_frame_;
    if (!sort_) sort_.emplace(device_);
    if (!keys_kernel_) {  // made last
        gather_kernel_ = device_.kernel("broad_phase/grid", "grid_gather");
        starts_kernel_ = device_.kernel("broad_phase/grid", "grid_starts");
        keys_kernel_ = device_.kernel("broad_phase/grid", "grid_keys");
    }
    const std::uint32_t n = boxes.count();
    stride_ = std::uint64_t{n} + padding;
    cells_ = frame.cells;
    device_.reserve(frame_, sizeof frame, "the frame of a grid");
    device_.write(frame_, &frame, sizeof frame);
    device_.reserve(keys_, n * sizeof(std::uint32_t), "cells of boxes");
    device_.reserve(order_, stride_ * sizeof(std::uint32_t), "the order of boxes");
    device_.reserve(columns_, stride_ * 6 * sizeof(float), "boxes as columns");
    device_.reserve(start_, (std::size_t{frame.cells} + 3) * sizeof(std::uint32_t), "the starts of cells");
    device_.launch_items(keys_kernel_.args(boxes.on(device_), boxes.first(), n, frame_, keys_), n);
    sort_->sort(keys_, order_, n, bits_of(std::uint64_t{frame.cells} + 1), true);
    device_.launch_items(
        gather_kernel_.args(boxes.on(device_), boxes.first(), order_, n, static_cast<std::uint32_t>(stride_), columns_),
        stride_);
    device_.launch_items(starts_kernel_.args(keys_, n, frame.cells, start_),
                         (std::size_t{frame.cells} + 3 + 255) / 256);
}

bool Grid::bin(BoxInput& boxes) {
    const std::uint32_t n = boxes.count();
    cells_ = 0;
    any_invalid_ = n == 1;  // one box is looked at on the host
    if (n < 2) return false;
    const BoxStatistics stats = statistics_.gather(boxes);
    any_invalid_ = stats.boxes < n;
    if (stats.boxes < 2) return false;
    const Choice choice = choose(stats, device_.info().lanes);
    small_ = choice.small;
    large_ = stats.boxes - choice.small;
    host_frame_ = make_frame(stats, choice);
    make_entries(boxes);
    return true;
}

void Grid::keep_entries_only() {
    sort_.reset();
    keys_ = Buffer();
}

void Grid::find(BoxInput& boxes, const FilterInput& filters, PairList& pairs, FindCounts& counts) {
    const bool binned = bin(boxes);
    counts.invalid_boxes = any_invalid_;
    if (!binned) return;
    std::vector<SinkLaunch> launches;
    Kernel& small = search_kernel("grid_small", filters);
    small.args(columns_, stride_, order_, start_, frame_);
    launches.push_back({&small, 5, (small_ + entries_a_task() - 1) / entries_a_task()});
    if (large_ > 0) {
        Kernel& large = search_kernel("grid_large", filters);
        large.args(columns_, stride_, order_, start_, frame_);
        launches.push_back({&large, 5, large_ * parts});
        Kernel& giants = search_kernel("grid_giants", filters);
        giants.args(columns_, stride_, order_, start_, cells_);
        launches.push_back({&giants, 5, large_ - 1});
    }
    sink_.collect(launches, filters, boxes.count(), pairs, counts);
}

std::unique_ptr<BroadPhaseAlgorithm> make_grid(Device* device, const BroadPhaseOptions& options) {
    return std::make_unique<Grid>(*device, options);
}

}  // namespace clinch::detail
