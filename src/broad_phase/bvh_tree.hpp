// The tree of the broad phase `bvh` (cl/broad_phase/bvh.cl): built, kept and refitted on a device.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "src/broad_phase/box_statistics.hpp"
#include "src/broad_phase/inputs.hpp"
#include "src/device/device.hpp"
#include "src/primitives/radix_sort.hpp"

namespace clinch::detail {

struct BvhFrame;
struct BvhLevels;

/// An implicit tree of WIDTH-wide nodes over boxes along a Hilbert curve. Which order it has is a matter of speed
/// alone: any search of it gives the same pairs.
class BvhTree {
public:
    explicit BvhTree(Device& device);

    /// From the next update() on the tree holds the boxes of these bodies only, at least one, until the next hold().
    void hold(const std::vector<std::uint32_t>& bodies);
    /// From the next update() on the tree holds all boxes, as at first.
    void hold_all();
    /// Makes the tree hold `boxes`, at least two if all are held. The order of the last call is kept while the
    /// bodies held, or if all are held their number, are the same and the tree has not become much worse than it was
    /// when built; else the boxes are sorted again. Waits. Cost: reads the boxes once; building reads them twice more
    /// and sorts them. When it throws, a hold() is to be said again.
    void update(BoxInput& boxes);
    /// Gives back the memory that only sorting takes, 12 bytes a box or, with long keys, 20; the next sort takes it
    /// anew.
    void release_sort_memory();
    /// Tells the box tests that a search of the tree took: the next update builds anew when they have become many more
    /// than right after the last build.
    void searched(std::uint64_t box_tests);

    /// The last update kept the order.
    bool kept_order() const noexcept { return kept_order_; }
    /// There was a box that is no box.
    bool any_invalid() const noexcept { return any_invalid_; }
    /// Boxes a block.
    std::uint32_t width() const noexcept { return width_; }
    /// Blocks of boxes.
    std::uint32_t blocks() const noexcept { return blocks_; }
    /// As the kernel bvh_search takes them.
    const Buffer& nodes() const noexcept { return tree_; }
    const Buffer& levels() const noexcept { return levels_; }
    const Buffer& order() const noexcept { return order_; }
    /// Names of the boxes in this order; order() itself where they have none.
    const Buffer& names() const noexcept { return named_ ? names_ : order_; }

private:
    void shape(std::uint32_t n);
    void build(BoxInput& boxes);
    unsigned write_frame(const BoxStatistics& stats, bool finest);
    void sort(BoxInput& boxes, const BoxStatistics& stats, bool finest);
    bool crowded();
    void name(const BoxInput& boxes);
    double fit(BoxInput& boxes, std::uint32_t n);
    std::uint32_t items_for(std::uint32_t nodes) const;

    Device& device_;
    const std::uint32_t width_;
    StatisticsGatherer statistics_;
    std::optional<RadixSort> sort32_, sort64_;
    struct KeyKernels {
        Kernel keys, crowded;
    };
    KeyKernels kernels32_, kernels64_;
    Kernel leaves_kernel_, level_kernel_, names_kernel_;
    std::uint64_t names_version_ = 0;  // of those in names_; 0: none are there
    bool named_ = false;
    Buffer names_, frame_, levels_, keys_, order_, tree_, measures_;
    std::vector<std::uint32_t> level_first_;  // block where each level begins; the last is the number of blocks
    std::uint32_t n_ = 0;                     // boxes of the last update that went well, else 0
    std::uint32_t shaped_ = 0;                // boxes that there is room for in blocks_ blocks
    std::uint32_t blocks_ = 0;
    double size_when_built_ = 0.0;
    std::uint64_t tests_when_built_ = 0;
    unsigned finest_builds_ = 0;  // builds to come that take the finest cells at once
    bool wide_keys_ = false;      // the keys sorted last have 64 bits
    bool listed_ = false;         // the tree holds the boxes whose numbers are in order_, shaped_ in all
    bool worn_ = false, kept_order_ = false, any_invalid_ = false;
};

}  // namespace clinch::detail
