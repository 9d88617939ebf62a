#include "src/broad_phase/bvh_tree.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "src/device/quirks.hpp"
#include "src/primitives/bits.hpp"

namespace clinch::detail {

// As the struct of the same name in bvh.cl.
struct BvhFrame {
    float origin[3];
    float scale;
    float most_cells;
    float size_limit[3];
    std::uint32_t class_shift, most_class;
    float measure;
};
static_assert(sizeof(BvhFrame) == 44, "kernels read this layout");

struct BvhLevels {
    std::uint32_t top;
    std::uint32_t first[12];
    std::uint32_t blocks;
};
static_assert(sizeof(BvhLevels) == 56, "kernels read this layout");

namespace {

struct BvhMeasure {
    float size;
    std::uint32_t invalid;
};
static_assert(sizeof(BvhMeasure) == 8, "kernels write this layout");

// A refitted tree is given up when the sum of the sizes of its nodes, which its search goes along with, has grown so
// much, or the box tests of the search have.
constexpr double most_growth = 1.5;
constexpr double most_test_growth = 1.25;

// Widest box of the narrower half.
float median_width(const BoxStatistics& stats) {
    std::uint32_t seen = 0;
    for (const WidthClass& width : stats.widths)
        if ((seen += width.count) >= stats.boxes - stats.boxes / 2) return width.widest;
    return 0.0f;
}

// Bits an axis that places on the curve need: cells as small as the boxes and as the room that each box has.
unsigned axis_bits(const BoxStatistics& stats, const double* extent, double widest, float median) {
    const double room = std::cbrt(extent[0] * extent[1] * extent[2] / stats.boxes);
    double cell = median > 0.0f ? static_cast<double>(median) : widest;
    if (room > 0.0 && room < cell) cell = room;
    const double cells = cell > 0.0 ? widest / cell : 0.0;
    return cells < 2097152.0 ? std::max(1u, bits_of(static_cast<std::uint64_t>(cells))) : 21u;
}

}  // namespace

BvhTree::BvhTree(Device& device) : device_(device), width_(std::max(device.info().lanes, 8u)), statistics_(device) {}

// Work-items that share `nodes`: a few for each core, or enough to fill a GPU; and so many that no loop is too long
// where loops end early.
std::uint32_t BvhTree::items_for(std::uint32_t nodes) const {
    const DeviceInfo& info = device_.info();
    const std::uint32_t turns = 4 * width_ + 32 * (width_ / info.lanes);  // at most, for a block and its node
    const std::uint32_t least = nodes / (most_loop_iterations(info) / turns) + 1;
    return std::max(least, std::clamp(nodes, 1u, info.compute_units * (info.lanes > 1 ? 16u : 512u)));
}

// Numbers the blocks of all levels and makes room for them.
void BvhTree::shape(std::uint32_t n) {
    if (shaped_ == n) return;
    shaped_ = 0;  // until all went well
    BvhLevels levels{};
    blocks_ = (n - 1) / width_ + 1;
    levels.blocks = blocks_;
    level_first_.assign(1, 0);
    std::uint32_t blocks = blocks_, first = 0;
    do {  // at least one level above the boxes
        first += blocks;
        level_first_.push_back(first);
        levels.first[++levels.top] = first;
        blocks = (blocks - 1) / width_ + 1;
    } while (blocks > 1);
    level_first_.push_back(first + 1);
    device_.reserve(levels_, sizeof levels, "the levels of a tree");
    device_.write(levels_, &levels, sizeof levels);
    device_.reserve(tree_, (std::size_t{first} + 1) * width_ * 6 * sizeof(float), "a tree of boxes");
    device_.reserve(order_, std::size_t{blocks_} * width_ * sizeof(std::uint32_t), "the order of boxes");
    device_.reserve(measures_, level_first_.size() * items_for(blocks_ + width_) * sizeof(BvhMeasure),
                    "the measures of a tree");
    shaped_ = n;
}

void BvhTree::hold(const std::vector<std::uint32_t>& bodies) {
    n_ = 0;
    shape(static_cast<std::uint32_t>(bodies.size()));
    device_.write(order_, bodies.data(), bodies.size() * sizeof bodies[0]);
    listed_ = true;
}

void BvhTree::hold_all() {
    if (listed_) n_ = 0;
    listed_ = false;
}

// Chooses the cells that the curve goes through and the classes of size; returns the bits of a key.
unsigned BvhTree::write_frame(const BoxStatistics& stats, bool finest) {
    double extent[3], widest = 0.0;
    const float median = median_width(stats);
    for (std::size_t d = 0; d < 3; ++d) {
        // Centres lie half a width above the min corners.
        extent[d] =
            static_cast<double>(stats.high[d]) - static_cast<double>(stats.low[d]) + static_cast<double>(median);
        widest = std::max(widest, extent[d]);
    }
    BvhFrame frame{};
    unsigned classes = 1;
    for (std::size_t c = 0; c < 3; ++c) {
        frame.size_limit[c] = 4.0f * median * static_cast<float>(1u << (3 * c));
        if (!stats.widths.empty() && stats.widths.back().widest > frame.size_limit[c])
            classes = static_cast<unsigned>(c) + 2;
    }
    const unsigned class_bits = bits_of(classes - 1);
    const unsigned most = class_bits > 0 ? 20 : 21;
    unsigned axis = finest ? most : axis_bits(stats, extent, widest, median);
    // A pass of the sort takes 8 bits: those that are paid for are used.
    axis = std::min(((class_bits + 3 * axis + 7) / 8 * 8 - class_bits) / 3, most);
    for (std::size_t d = 0; d < 3; ++d) frame.origin[d] = stats.low[d];
    const double cells = static_cast<double>(std::uint64_t{1} << axis);
    frame.scale = widest > 0.0 ? static_cast<float>(std::min(cells / widest, 1e30)) : 0.0f;
    frame.most_cells = static_cast<float>(cells - 1.0);
    frame.class_shift = 3 * axis;
    frame.most_class = classes - 1;
    frame.measure = widest > 0.0 ? static_cast<float>(std::min(1.0 / widest, 1e30)) : 0.0f;
    device_.reserve(frame_, sizeof frame, "the frame of a tree");
    device_.write(frame_, &frame, sizeof frame);
    return 3 * axis + class_bits;
}

// Sorts the boxes along the curve; with `finest`, through the smallest cells there are.
void BvhTree::sort(BoxInput& boxes, const BoxStatistics& stats, bool finest) {
    const std::uint32_t n = shaped_;
    const unsigned bits = write_frame(stats, finest);
    wide_keys_ = bits > 32;
    KeyKernels& kernels = wide_keys_ ? kernels64_ : kernels32_;
    const char* const defines = wide_keys_ ? "-DKEY=ulong" : "";
    if (!kernels.keys) kernels.keys = device_.kernel("broad_phase/bvh", "bvh_keys", defines);
    if (!kernels.crowded) kernels.crowded = device_.kernel("broad_phase/bvh", "bvh_crowded", defines);
    device_.reserve(keys_, std::size_t{n} * (wide_keys_ ? sizeof(std::uint64_t) : sizeof(std::uint32_t)),
                    "the keys of boxes");
    device_.launch_items(
        kernels.keys.args(boxes.on(device_), boxes.first(), n, frame_, order_, listed_ ? 1u : 0u, keys_),
        n / device_.info().lanes + 1);
    std::optional<RadixSort>& sorter = wide_keys_ ? sort64_ : sort32_;
    if (!sorter) sorter.emplace(device_, wide_keys_ ? RadixSort::Key::Bits64 : RadixSort::Key::Bits32);
    sorter->sort(keys_, order_, n, bits, !listed_);
}

void BvhTree::release_sort_memory() {
    sort32_.reset();
    sort64_.reset();
    keys_ = Buffer();
}

// Whether so many blocks lie in a single cell that searching them, each against each if they are all in the same, would
// cost more than all others, which meet some sixteen each. Waits.
bool BvhTree::crowded() {
    constexpr std::uint32_t few_blocks = 128;  // each against each of these is less than one more sort
    if (blocks_ <= few_blocks) return false;
    const std::uint32_t whole_blocks = blocks_ - 1;
    const std::uint32_t items = items_for(whole_blocks), per_item = (whole_blocks - 1) / items + 1;
    const std::size_t group = device_.group_size();
    device_.launch((wide_keys_ ? kernels64_ : kernels32_).crowded.args(keys_, whole_blocks, per_item, items, measures_),
                   (items + group - 1) / group, group);
    std::vector<std::uint32_t> counts(items);
    device_.read(measures_, counts.data(), items * sizeof counts[0]);
    const double count = std::accumulate(counts.begin(), counts.end(), 0.0);
    return count * count > 16.0 * blocks_;
}

// Chooses cells and sorts the boxes. Cells are made from how wide and how many boxes are; where that proves too coarse,
// as for a heap of sand among boulders, the finest are taken, and for some builds to come at once.
void BvhTree::build(BoxInput& boxes) {
    constexpr unsigned builds_with_finest = 16;
    const BoxStatistics stats = statistics_.gather(boxes);
    const bool finest = finest_builds_ > 0;
    sort(boxes, stats, finest);
    if (finest) {
        --finest_builds_;
    } else if (crowded()) {
        finest_builds_ = builds_with_finest;
        sort(boxes, stats, true);
    }
}

// Computes all blocks of boxes and all nodes in the order there is. Returns the sum of the sizes of nodes. Waits.
double BvhTree::fit(BoxInput& boxes, std::uint32_t n) {
    if (!leaves_kernel_) {  // made last
        level_kernel_ = device_.kernel("broad_phase/bvh", "bvh_level");
        leaves_kernel_ = device_.kernel("broad_phase/bvh", "bvh_leaves");
    }
    const std::size_t group = device_.group_size();
    std::uint32_t first_measure = 0;
    for (std::size_t level = 1; level + 1 < level_first_.size(); ++level) {
        const std::uint32_t below = level_first_[level] - level_first_[level - 1];
        const std::uint32_t nodes = (level_first_[level + 1] - level_first_[level]) * width_;
        const std::uint32_t items = items_for(nodes), per_item = (nodes - 1) / items + 1;
        if (level == 1)
            leaves_kernel_.args(boxes.on(device_), boxes.first(), order_, n, frame_, below, level_first_[1], nodes,
                                per_item, items, tree_, first_measure, measures_);
        else
            level_kernel_.args(frame_, level_first_[level - 1], below, level_first_[level], nodes, per_item, items,
                               tree_, first_measure, measures_);
        device_.launch(level == 1 ? leaves_kernel_ : level_kernel_, (items + group - 1) / group, group);
        first_measure += items;
    }
    std::vector<BvhMeasure> measures(first_measure);
    device_.read(measures_, measures.data(), measures.size() * sizeof measures[0]);
    double size = 0.0;
    any_invalid_ = false;
    for (const BvhMeasure& measure : measures) {
        size += static_cast<double>(measure.size);
        any_invalid_ = any_invalid_ || measure.invalid != 0;
    }
    return size;
}

void BvhTree::update(BoxInput& boxes) {
    const std::uint32_t n = listed_ ? shaped_ : boxes.count();
    const bool try_old_order = n_ == n && !worn_;
    n_ = 0;  // until all went well
    kept_order_ = try_old_order && fit(boxes, n) <= most_growth * size_when_built_;
    if (!kept_order_) {
        shape(n);
        build(boxes);
        size_when_built_ = fit(boxes, n);
        tests_when_built_ = 0;
        worn_ = false;
    }
    name(boxes);
    n_ = n;
}

// Keeps the names while they and the order are the same.
void BvhTree::name(const BoxInput& boxes) {
    named_ = boxes.names() != nullptr;
    if (!kept_order_) names_version_ = 0;
    if (!named_ || (boxes.names_version() != 0 && boxes.names_version() == names_version_)) return;
    names_version_ = 0;
    if (!names_kernel_) names_kernel_ = device_.kernel("broad_phase/bvh", "bvh_names");
    device_.reserve(names_, order_.bytes(), "the names of boxes");
    device_.launch_items(names_kernel_.args(order_, *boxes.names(), shaped_, names_), shaped_);
    names_version_ = boxes.names_version();
}

void BvhTree::searched(std::uint64_t box_tests) {
    if (tests_when_built_ == 0)
        tests_when_built_ = box_tests;
    else
        worn_ = static_cast<double>(box_tests) > most_test_growth * static_cast<double>(tests_when_built_);
}

}  // namespace clinch::detail
