// What a broad-phase algorithm works on, on the host or on a device, moved only when asked for there.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/broad_phase.hpp"
#include "clinch/view.hpp"
#include "src/device/device.hpp"

namespace clinch::detail {

/// Where the overlap of a pair begins on an axis: in [low, high).
struct BeginRange {
    std::uint32_t axis = 0;
    float low = -HUGE_VALF, high = HUGE_VALF;
};

/// The boxes of one call. Where they are not yet is filled in on first use and kept for the call.
class BoxInput {
public:
    /// Boxes in the caller's memory. `staging` is where they go on a device; kept by the caller.
    BoxInput(View<const Aabb> boxes, Buffer& staging);
    /// `count` boxes in memory of `device`, from box `first` on.
    BoxInput(Device& device, cl_mem boxes, std::uint64_t first, std::uint32_t count);

    std::uint32_t count() const noexcept { return count_; }
    /// Whether they are in host memory, without asking a device.
    bool is_on_host() const noexcept { return host_.data() != nullptr; }
    /// On the host; waits for a device that has them.
    View<const Aabb> on_host();
    /// On `device`; box number 0 is at first().
    cl_mem on(Device& device);
    std::uint64_t first() const noexcept { return first_; }

    /// Boxes are some of many: their numbers among all `bodies`, ascending, are in `names` on the device that has the
    /// boxes, and are those of the last call with this `version`. An algorithm may put them out in place of places in
    /// this list, and then sets FindCounts::named.
    void name(const Buffer& names, std::uint64_t version, std::uint32_t bodies) {
        names_ = &names;
        names_version_ = version;
        bodies_ = bodies;
    }
    /// Only pairs whose overlap begins in this range are wanted. An algorithm may find others all the same,
    /// unless its row says that it does not (AlgorithmRow::in_range).
    void want(const BeginRange& range) noexcept { range_ = range; }
    const BeginRange& wanted() const noexcept { return range_; }
    /// Null: boxes have their places as names.
    const Buffer* names() const noexcept { return names_; }
    std::uint64_t names_version() const noexcept { return names_version_; }
    /// Names are below this.
    std::uint32_t bodies() const noexcept { return names_ != nullptr ? bodies_ : count_; }

private:
    View<const Aabb> host_;
    std::vector<Aabb> read_back_;
    Device* device_ = nullptr;
    cl_mem memory_ = nullptr;
    Buffer* staging_ = nullptr;
    Buffer own_;  // where they go from one device to another
    const Buffer* names_ = nullptr;
    std::uint64_t first_ = 0, names_version_ = 0;
    std::uint32_t count_ = 0, bodies_ = 0;
    BeginRange range_;
};

/// The filters of one call. `version` (if not 0) tells that they are those of the last call with it.
struct FilterInput {
    FilterColumns columns;
    std::uint64_t version = 0;

    /// False when every pair passes.
    bool any() const noexcept {
        return columns.group != nullptr || columns.mask != nullptr || columns.motion != nullptr;
    }
    bool can_move(std::uint32_t i) const noexcept {
        return columns.motion == nullptr || columns.motion[i] == Motion::Dynamic ||
               columns.motion[i] == Motion::Kinematic;
    }
    std::uint32_t group(std::uint32_t i) const noexcept { return columns.group == nullptr ? 1u : columns.group[i]; }
    std::uint32_t mask(std::uint32_t i) const noexcept { return columns.mask == nullptr ? ~0u : columns.mask[i]; }
    /// Group and mask of both allow the pair.
    bool allows(std::uint32_t a, std::uint32_t b) const noexcept {
        return (group(a) & mask(b)) != 0 && (group(b) & mask(a)) != 0;
    }
};

/// Filters as kernels read them: (group, mask, can move, 0) a body. Sent again only when they change.
class FilterMirror {
public:
    explicit FilterMirror(Device& device) : device_(device) {}
    /// The buffer for `count` bodies.
    const Buffer& on_device(const FilterInput& filters, std::uint32_t count);

private:
    Device& device_;
    Buffer buffer_;
    std::uint64_t version_ = 0;
    std::uint32_t count_ = 0;
};

}  // namespace clinch::detail
