// grid: boxes binned by their min corner [thesis 4.2.6]. See cl/broad_phase/grid.cl.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "src/broad_phase/algorithm.hpp"
#include "src/broad_phase/box_statistics.hpp"
#include "src/broad_phase/pair_sink.hpp"
#include "src/primitives/radix_sort.hpp"

namespace clinch::detail {

/// As the struct of the same name in grid_cells.clh.
struct GridFrame {
    float origin[3];
    float scale[3];
    std::uint32_t size[3];
    std::uint32_t wrap[3];
    std::uint32_t cells;
    float widest;
    float reach;
    float span;
    float side;
};
static_assert(sizeof(GridFrame) == 68, "kernels read this layout");

/// The entries of a grid as its last search left them, on the device: boxes in the order of their cells as columns,
/// then large boxes, then those that are no boxes, then NaN. Columns stand `stride` apart; `order` gives the boxes'
/// numbers.
struct GridBins {
    const Buffer& columns;
    const Buffer& order;
    const Buffer& start;
    const Buffer& frame;
    std::uint64_t stride;
    std::uint32_t cells;
};

class Grid : public BroadPhaseAlgorithm {
public:
    Grid(Device& device, const BroadPhaseOptions& options)
        : device_(device), options_(options), statistics_(device), sink_(device, options) {}

    void find(BoxInput& boxes, const FilterInput& filters, PairList& pairs, FindCounts& counts) override;
    /// Makes the entries and looks for no pairs. False, without entries, when there are less than two boxes.
    bool bin(BoxInput& boxes);
    /// Whether there were boxes that are no boxes.
    bool any_invalid() const noexcept { return any_invalid_; }
    /// Gives back the device memory that only making the entries needed.
    void keep_entries_only();
    /// As of the last bin() or find(), and valid until the next.
    GridBins bins() const { return {columns_, order_, start_, frame_, stride_, cells_}; }
    const GridFrame& frame() const noexcept { return host_frame_; }
    /// Entries behind the last that vector loads may touch.
    static constexpr std::uint32_t padding = 64;

private:
    void make_entries(BoxInput& boxes);
    Kernel& search_kernel(const char* name, const FilterInput& filters);
    std::uint32_t entries_a_task() const;

    Device& device_;
    const BroadPhaseOptions& options_;
    StatisticsGatherer statistics_;
    std::optional<RadixSort> sort_;
    PairSink sink_;
    Kernel keys_kernel_, gather_kernel_, starts_kernel_;
    std::map<std::string, Kernel> search_kernels_;
    Buffer frame_, keys_, order_, columns_, start_;
    std::uint64_t stride_ = 0;
    GridFrame host_frame_{};
    std::uint32_t cells_ = 0, small_ = 0, large_ = 0;  // cells, and boxes of the two kinds
    bool any_invalid_ = false;
};

}  // namespace clinch::detail
