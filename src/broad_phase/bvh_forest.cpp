#include "src/broad_phase/bvh_forest.hpp"

#include <algorithm>
#include <utility>

#include "src/device/quirks.hpp"

namespace clinch::detail {
namespace {

// Two trees pay from this share of still bodies on; they stay until it has become half of that.
constexpr std::uint32_t least_share = 8;

}  // namespace

// Finds out which bodies cannot move and whether that calls for two trees. Returns whether all is as it was in the
// last update.
bool BvhForest::divide(std::uint32_t n, const FilterInput& filters) {
    const bool was_split = split_, same_count = std::exchange(n_, 0) == n;
    const Motion* const motion = filters.columns.motion;
    if (motion == nullptr || n < fewest_) {
        split_ = false;
        return same_count && !was_split;
    }
    if (same_count && filters.version != 0 && filters.version == version_) return true;
    version_ = 0;
    std::uint32_t still = 0, changed = same_count && is_still_.size() == n ? 0 : 1;
    is_still_.resize(n);
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint8_t now = motion[i] == Motion::Static || motion[i] == Motion::Sleeping ? 1 : 0;
        changed |= now == is_still_[i] ? 0u : 1u;
        still += now;
        is_still_[i] = now;
    }
    still_count_ = still;
    split_ = still >= n / (was_split ? 2 * least_share : least_share);
    return same_count && split_ == was_split && (!split_ || changed == 0);
}

// Gives each tree its bodies.
void BvhForest::take_bodies() {
    std::vector<std::uint32_t> still;
    still.reserve(still_count_);
    movers_.clear();
    movers_.reserve(is_still_.size() - still_count_);
    for (std::uint32_t i = 0; i < is_still_.size(); ++i) (is_still_[i] != 0 ? still : movers_).push_back(i);
    device_.reserve(still_bodies_, still.size() * sizeof still[0], "the still bodies");
    device_.write(still_bodies_, still.data(), still.size() * sizeof still[0]);
    still_.hold(still);
    if (!movers_.empty()) moving_.hold(movers_);
}

// Whether a body that cannot move has another box than in the last call, which waits; with `fresh` there was none.
// Keeps the boxes.
bool BvhForest::still_boxes_changed(BoxInput& boxes, bool fresh) {
    if (!compare_kernel_) compare_kernel_ = device_.kernel("broad_phase/bvh", "bvh_compare");
    const DeviceInfo& info = device_.info();
    const std::uint32_t least = still_count_ / (most_loop_iterations(info) / 2) + 1;  // no longer loops
    const std::uint32_t items =
        std::max(least, std::clamp(still_count_ / 256, 1u, info.compute_units * (info.lanes > 1 ? 8u : 512u)));
    device_.reserve(still_boxes_, std::size_t{still_count_} * sizeof(Aabb), "the boxes of still bodies");
    device_.reserve(changed_, items * sizeof(std::uint32_t), "whether still bodies changed");
    const std::size_t group = device_.group_size();
    device_.launch(compare_kernel_.args(boxes.on(device_), boxes.first(), still_bodies_, still_count_,
                                        (still_count_ - 1) / items + 1, items, fresh ? 1u : 0u, still_boxes_, changed_),
                   (items + group - 1) / group, group);
    if (fresh) return true;
    std::vector<std::uint32_t> changed(items);
    device_.read(changed_, changed.data(), items * sizeof changed[0]);
    return std::any_of(changed.begin(), changed.end(), [](std::uint32_t one) { return one != 0; });
}

void BvhForest::update_still(BoxInput& boxes, bool same_bodies) {
    if (same_bodies && !still_boxes_changed(boxes, false)) {
        kept_ = still_count_;
        return;
    }
    if (!same_bodies) take_bodies();
    still_.update(boxes);
    // It is seldom sorted: that memory now serves to keep the boxes.
    still_.release_sort_memory();
    if (!same_bodies) still_boxes_changed(boxes, true);
}

void BvhForest::update(BoxInput& boxes, const FilterInput& filters) {
    const std::uint32_t n = boxes.count();
    const bool same_bodies = divide(n, filters);
    kept_ = 0;
    if (split_) {
        update_still(boxes, same_bodies);
    } else {
        moving_.hold_all();
    }
    if (moving() != nullptr) moving_.update(boxes);
    n_ = n;
    version_ = filters.version;
}

}  // namespace clinch::detail
