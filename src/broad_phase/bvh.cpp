// bvh: boxes along a Hilbert curve with a wide tree above them, refitted from call to call; where many
// bodies cannot move, they have a tree of their own. See cl/broad_phase/bvh.cl.
#include <limits>
#include <string>
#include <vector>

#include "clinch/error.hpp"
#include "src/broad_phase/algorithm.hpp"
#include "src/broad_phase/bvh_forest.hpp"
#include "src/broad_phase/pair_sink.hpp"
#include "src/device/quirks.hpp"

namespace clinch::detail {
namespace {

class Bvh : public BroadPhaseAlgorithm {
public:
    Bvh(Device& device, const BroadPhaseOptions& options) : device_(device), trees_(device), sink_(device, options) {}

    void find(BoxInput& boxes, const FilterInput& filters, PairList& pairs, FindCounts& counts) override;

private:
    std::uint32_t window(const BvhTree& tree) const;
    SinkLaunch search(const BvhTree& tree, const BvhTree& other, const FilterInput& filters, const BeginRange& wanted);

    Device& device_;
    BvhForest trees_;
    PairSink sink_;
    Kernel search_kernels_[2][2];  // within a tree, from one into another; each without and with filters
};

// Blocks that one work-item may look at on a device where loops end early; 0: any number.
std::uint32_t Bvh::window(const BvhTree& tree) const {
    const std::uint32_t most = most_loop_iterations(device_.info());
    if (most == std::numeric_limits<std::uint32_t>::max()) return 0;
    // Turns that one more block costs at most. Without lanes: two looks at it, then each of its boxes against each of
    // the other block. With lanes: taken up lane by lane, the same, and each pair put out. Half the turns are left
    // for the way through the tree and for the last candidates.
    const std::uint32_t lanes = device_.info().lanes, width = tree.width(), steps = width / lanes;
    const std::uint32_t turns =
        lanes == 1 ? steps * (width + 3) + 8 : steps * (7 * lanes + 1 + width * (2 * lanes + 5));
    return most / 2 / turns;
}

// The blocks of a tree against those of the other, or if that is the same one, each two of them once.
SinkLaunch Bvh::search(const BvhTree& tree, const BvhTree& other, const FilterInput& filters,
                       const BeginRange& wanted) {
    constexpr std::uint32_t own_parameters = 10;
    const std::uint32_t width = window(tree);
    const bool same = &tree == &other;
    Kernel& kernel = search_kernels_[same ? 0 : 1][filters.any() ? 1 : 0];
    if (!kernel) {
        std::string defines = PairSink::defines(filters);
        if (width > 0) defines += " -DWINDOW=" + std::to_string(width);
        kernel = device_.kernel("broad_phase/bvh", "bvh_search", defines);
    }
    kernel.args(tree.nodes(), tree.levels(), tree.names(), other.nodes(), other.levels(), other.names(), same ? 1u : 0u,
                wanted.axis, wanted.low, wanted.high);
    if (width == 0) return {&kernel, own_parameters, tree.blocks()};
    const std::uint64_t tasks = std::uint64_t{tree.blocks()} * ((other.blocks() - 1) / width + 1);
    if (tasks > std::numeric_limits<std::uint32_t>::max())
        throw Error(ErrorCode::LimitExceeded, "bvh cannot search so many boxes on '" + device_.info().name +
                                                  "', whose driver has the quirk loops-end-early; brute can");
    return {&kernel, own_parameters, static_cast<std::uint32_t>(tasks), 1};
}

void Bvh::find(BoxInput& boxes, const FilterInput& filters, PairList& pairs, FindCounts& counts) {
    const std::uint32_t n = boxes.count();
    if (n < 2) {
        counts.invalid_boxes = n == 1;  // one box is looked at on the host
        return;
    }
    trees_.update(boxes, filters);
    counts.invalid_boxes = trees_.any_invalid();
    counts.still = trees_.kept();
    const BvhTree* const moving = trees_.moving();
    if (moving == nullptr) return;
    // With two trees no pair comes up of which neither can move: without groups and masks there is nothing to filter.
    const bool all_pass = trees_.split() && filters.columns.group == nullptr && filters.columns.mask == nullptr;
    const FilterInput applied = all_pass ? FilterInput{} : filters;
    std::vector<SinkLaunch> launches{search(*moving, *moving, applied, boxes.wanted())};
    if (const BvhTree* const still = trees_.still(); still != nullptr) {
        // From the fuller tree, whose blocks are the smaller: those of a sparse one reach over many boxes.
        const bool from_still = still->blocks() >= moving->blocks();
        launches.push_back(from_still ? search(*still, *moving, applied, boxes.wanted())
                                      : search(*moving, *still, applied, boxes.wanted()));
    }
    const std::uint64_t tests_before = counts.box_tests;
    counts.named = boxes.names() != nullptr;
    sink_.collect(launches, applied, boxes.bodies(), pairs, counts);
    trees_.searched(counts.box_tests - tests_before);
}

}  // namespace

std::unique_ptr<BroadPhaseAlgorithm> make_bvh(Device* device, const BroadPhaseOptions& options) {
    return std::make_unique<Bvh>(*device, options);
}

}  // namespace clinch::detail
