// Space cut across one axis, so that each of several devices finds the pairs of one part [thesis 5.2].
#pragma once

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
    double copies = 0.0;      ///< boxes that slabs have beyond one each, a box, as a sample has it
    std::size_t count() const noexcept { return cuts.size() + 1; }
    /// Of a box that is no box on the axis: the slab where it is met, and found to be none.
    SlabSpan span_of(const Aabb& box) const noexcept;
};

/// Slabs in which boxes begin in proportion to `fractions` (which add up to 1; at most Slabs::most of them), across the
/// axis on which the fewest boxes reach over a cut. By a sample of 4,096 boxes, always the same ones: less than a
/// millisecond.
Slabs choose_slabs(View<const Aabb> boxes, const std::vector<double>& fractions);

/// The boxes of each slab. Keeps its memory between calls.
class SlabDeal {
public:
    /// Two passes over the boxes on the host's threads.
    void deal(View<const Aabb> boxes, const Slabs& slabs);
    /// Numbers of the boxes that reach into slab s, ascending.
    const std::vector<std::uint32_t>& members(std::size_t s) const noexcept { return members_[s]; }
    SlabSpan span(std::uint32_t box) const noexcept { return spans_[box]; }
    std::size_t boxes() const noexcept { return spans_.size(); }
    std::size_t slabs() const noexcept { return members_.size(); }
    std::size_t host_bytes() const noexcept;

private:
    std::vector<SlabSpan> spans_;
    std::vector<std::vector<std::uint32_t>> members_;
    std::vector<std::size_t> places_;  // of each block's members in each slab
};

}  // namespace clinch::detail
