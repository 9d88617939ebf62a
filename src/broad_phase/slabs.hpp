// Space cut across one axis, so that each of several devices finds the pairs of one part [thesis 5.2].
#pragma once

#include <algorithm>
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
    std::vector<float> cuts;  ///< ascending
    float slack = 0.0f;       ///< boxes this near to a slab are its members, too: they may be in it next time
    double copies = 0.0;      ///< members that slabs have beyond one each, a box, as a sample has it
    std::size_t count() const noexcept { return cuts.size() + 1; }
    /// Of a box that is no box on the axis: the slab where it is met, and found to be none.
    SlabSpan span_of(const Aabb& box) const noexcept { return span_of(box.min[axis], box.max[axis]); }
    /// Those that it is made a member of.
    SlabSpan members_of(const Aabb& box) const noexcept {
        return span_of(box.min[axis] - slack, box.max[axis] + slack);
    }

private:
    SlabSpan span_of(float min, float max) const noexcept {
        SlabSpan span{0, 0};
        for (const float cut : cuts) {
            span.first = static_cast<std::uint8_t>(span.first + (min >= cut ? 1 : 0));
            span.last = static_cast<std::uint8_t>(span.last + (max >= cut ? 1 : 0));
        }
        span.last = std::max(span.first, span.last);
        return span;
    }
};

/// Slabs in which boxes begin in proportion to `fractions` (which add up to 1; at most Slabs::most of them), across the
/// axis on which the fewest boxes reach over a cut. The axis by a sample of 4,096 boxes, the cuts by where 65,536 of
/// them begin (all, where they are not more): a share is off by 0.2 % of all boxes (one deviation) at most. Always the
/// same samples. Of a million boxes about a millisecond, twice that for many slabs.
Slabs choose_slabs(View<const Aabb> boxes, const std::vector<double>& fractions);

/// The boxes of each slab. Members stay the same from call to call while they can, so that what an algorithm has made
/// of them can be used again.
class SlabDeal {
public:
    /// Two passes over the boxes on the host's threads.
    void deal(View<const Aabb> boxes, const Slabs& slabs);
    /// For boxes that moved since: keeps cuts and members, in one pass. False if it cannot: there are more or fewer
    /// boxes, or one reaches into a slab that it is no member of.
    bool keep(View<const Aabb> boxes);
    /// Whether look() may take the place of keep(): there are as many boxes as were dealt.
    bool is_of(std::size_t boxes) const noexcept { return boxes == spans_.size() && members_.size() == slabs_.count(); }
    /// keep(), box by box: how `box`, a member of slab s, lies now. False if it reaches into a slab that it is no
    /// member of. After all members of all slabs were looked at, keep() would change nothing. Slabs side by side.
    bool look(std::size_t s, std::uint32_t number, const Aabb& box) noexcept {
        const SlabSpan span = slabs_.span_of(box), in = member_of_[number];
        if (in.first == s) spans_[number] = span;  // by one slab alone
        return span.first >= in.first && span.last <= in.last;
    }
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
    std::vector<std::size_t> places_;  // of each block's members in each slab
};

}  // namespace clinch::detail
