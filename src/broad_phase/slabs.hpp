// Space cut across one axis, so that each of several devices finds the pairs of one part [thesis 5.2].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/view.hpp"

namespace clinch::detail {

/// Which slabs a box reaches into.
struct SlabSpan {
    std::uint8_t first, last;
};

/// Slabs between planes: slab s is what lies in [cuts[s - 1], cuts[s]) on the axis, the first and the last without end.
/// A pair belongs to the slab where its overlap begins on the axis, that is, to the first slab that both boxes reach
/// into: each pair to one.
struct Slabs {
    static constexpr std::size_t most = 255;
    int axis = 0;
    std::vector<float> cuts;  ///< ascending; none between 0 and the least normal number, which devices may take for 0
    float slack = 0.0f;       ///< boxes this near to a slab are its members, too: they may be in it next time
    double copies = 0.0;      ///< members that slabs have beyond one each, a box, as a sample has it
    std::size_t count() const noexcept { return cuts.size() + 1; }
    /// Where the overlaps of pairs that belong to slab s begin: in [low, high).
    float low(std::size_t s) const noexcept { return s == 0 ? -HUGE_VALF : cuts[s - 1]; }
    float high(std::size_t s) const noexcept { return s == cuts.size() ? HUGE_VALF : cuts[s]; }
    /// Of a box that is no box on the axis: the slab where it is met, and found to be none.
    SlabSpan span_of(const Aabb& box) const noexcept { return span_of(box.min[axis], box.max[axis]); }
    /// Those that it is made a member of.
    SlabSpan members_of(const Aabb& box) const noexcept {
        return span_of(box.min[axis] - slack, box.max[axis] + slack);
    }

private:
    SlabSpan span_of(float min, float max) const noexcept {
        unsigned first = 0, last = 0;  // not in bytes, which for all a compiler knows may be those of `cuts`
        for (const float cut : cuts) {
            first += min >= cut ? 1U : 0U;
            last += max >= cut ? 1U : 0U;
        }
        return {static_cast<std::uint8_t>(first), static_cast<std::uint8_t>(std::max(first, last))};
    }
};

/// Slabs with centres of boxes in proportion to `fractions` (which add up to 1; at most Slabs::most of them), across
/// the axis on which the fewest boxes reach over a cut; nothing is in a first or last one of which the fraction is 0.
/// By centres, so that both sides of a cut have as many of the boxes that reach over it. The axis by a sample of 4,096
/// boxes, the cuts by the centres of 65,536 of them (all, where they are not more): a share is off by 0.2 % of all
/// boxes (one deviation) at most. Always the same samples. Of a million boxes about a millisecond, twice that for many
/// slabs.
Slabs choose_slabs(View<const Aabb> boxes, const std::vector<double>& fractions);

/// The boxes of each slab. Members stay the same from call to call while they can, so that what an algorithm has made
/// of them can be used again.
class SlabDeal {
public:
    /// Two passes over the boxes on the host's threads.
    void deal(View<const Aabb> boxes, const Slabs& slabs);
    /// For boxes that moved since: keeps cuts and members, in one pass. False if it cannot: there are more or fewer
    /// boxes, or one reaches into a slab that it is no member of. On the way members of slab s go to rows[s], if there
    /// is such a row and it is not null, in their order; what is there if it cannot is of no use.
    /// Without `spans`, which takes less time, span() and owner() are of no use afterwards.
    bool keep(View<const Aabb> boxes, const std::vector<Aabb*>& rows = {}, bool spans = true);
    const Slabs& slabs() const noexcept { return slabs_; }
    /// Another one after each deal(), none of them 0.
    std::uint64_t version() const noexcept { return version_; }
    /// Numbers of the boxes of slab s, ascending: all that reach into it, and some near to it.
    const std::vector<std::uint32_t>& members(std::size_t s) const noexcept { return members_[s]; }
    SlabSpan span(std::uint32_t box) const noexcept { return spans_[box]; }
    /// The slabs that the box is a member of.
    SlabSpan member_of(std::uint32_t box) const noexcept { return member_of_[box]; }
    /// The slab that a pair belongs to.
    std::size_t owner(std::uint32_t a, std::uint32_t b) const noexcept {
        return std::max(spans_[a].first, spans_[b].first);
    }
    std::size_t boxes() const noexcept { return spans_.size(); }
    std::size_t count() const noexcept { return members_.size(); }
    std::size_t host_bytes() const noexcept;

private:
    Slabs slabs_;
    std::uint64_t version_ = 0;
    std::vector<SlabSpan> spans_, member_of_;
    std::vector<std::vector<std::uint32_t>> members_;
    std::vector<std::size_t> places_;  // of each block's first member in each slab
};

}  // namespace clinch::detail
