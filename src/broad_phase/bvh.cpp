// bvh: boxes along a Hilbert curve with a wide tree above them, refitted from call to call. See cl/broad_phase/bvh.cl.
#include <limits>
#include <string>

#include "clinch/error.hpp"
#include "src/broad_phase/algorithm.hpp"
#include "src/broad_phase/bvh_tree.hpp"
#include "src/broad_phase/pair_sink.hpp"
#include "src/device/quirks.hpp"

namespace clinch::detail {
namespace {

class Bvh : public BroadPhaseAlgorithm {
public:
    Bvh(Device& device, const BroadPhaseOptions& options) : device_(device), tree_(device), sink_(device, options) {}

    void find(BoxInput& boxes, const FilterInput& filters, PairList& pairs, FindCounts& counts) override;

private:
    std::uint32_t window() const;
    SinkLaunch search(const FilterInput& filters);

    Device& device_;
    BvhTree tree_;
    PairSink sink_;
    Kernel search_kernels_[2];  // without and with filters
};

// Blocks that one work-item may look at on a device where loops end early; 0: any number.
std::uint32_t Bvh::window() const {
    const std::uint32_t most = most_loop_iterations(device_.info());
    if (most == std::numeric_limits<std::uint32_t>::max()) return 0;
    // Turns that one more block costs at most. Without lanes: two looks at it, then each of its boxes against each of
    // the other block. With lanes: taken up lane by lane, the same, and each pair put out. Half the turns are left
    // for the way through the tree and for the last candidates.
    const std::uint32_t lanes = device_.info().lanes, width = tree_.width(), steps = width / lanes;
    const std::uint32_t turns =
        lanes == 1 ? steps * (width + 3) + 8 : steps * (7 * lanes + 1 + width * (2 * lanes + 5));
    return most / 2 / turns;
}

SinkLaunch Bvh::search(const FilterInput& filters) {
    const std::uint32_t blocks = tree_.blocks(), width = window();
    Kernel& kernel = search_kernels_[filters.any() ? 1 : 0];
    if (!kernel) {
        std::string defines = PairSink::defines(filters);
        if (width > 0) defines += " -DWINDOW=" + std::to_string(width);
        kernel = device_.kernel("broad_phase/bvh", "bvh_search", defines);
    }
    kernel.args(tree_.nodes(), tree_.levels(), tree_.order());
    if (width == 0) return {&kernel, 3, blocks};
    const std::uint64_t tasks = std::uint64_t{blocks} * ((blocks - 1) / width + 1);
    if (tasks > std::numeric_limits<std::uint32_t>::max())
        throw Error(ErrorCode::LimitExceeded, "bvh cannot search so many boxes on '" + device_.info().name +
                                                  "', whose driver has the quirk loops-end-early; brute can");
    return {&kernel, 3, static_cast<std::uint32_t>(tasks), 1};
}

void Bvh::find(BoxInput& boxes, const FilterInput& filters, PairList& pairs, FindCounts& counts) {
    const std::uint32_t n = boxes.count();
    if (n < 2) {
        counts.invalid_boxes = n == 1;  // one box is looked at on the host
        return;
    }
    tree_.update(boxes);
    counts.invalid_boxes = tree_.any_invalid();
    const std::uint64_t tests_before = counts.box_tests;
    sink_.collect({search(filters)}, filters, n, pairs, counts);
    tree_.searched(counts.box_tests - tests_before);
}

}  // namespace

std::unique_ptr<BroadPhaseAlgorithm> make_bvh(Device* device, const BroadPhaseOptions& options) {
    return std::make_unique<Bvh>(*device, options);
}

}  // namespace clinch::detail
