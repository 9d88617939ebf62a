// The corners of pairs from one call to the next, found again by the pairs' bodies.
#pragma once

#include <cstdint>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/view.hpp"
#include "clinch/warm_start.hpp"

namespace clinch {

struct WarmStart::Impl {
    /// As Touch::corners of cl/narrow_phase/touch.clh.
    struct Corners {
        std::uint32_t names[4];
        bool any() const noexcept { return names[0] != none; }
    };
    static constexpr std::uint32_t none = 0xffff;  ///< NO_CORNER of cl/narrow_phase/support.clh

    /// Those of the last call, in its order, and what decided them.
    std::vector<Pair> pairs;
    std::vector<Corners> corners;

    /// Takes new pairs in place of the old; what is known of those that were there before goes with them. Returns how
    /// many. Cost: linear for ascending lists, else n log n.
    std::size_t take(View<const Pair> now);
    /// What was known of the pairs from number `first` on before the call that take() was for, again: a device that
    /// failed may have left anything of them. Returns how many there are. Several threads at once, of pairs of their
    /// own.
    std::size_t restore(std::size_t first, std::size_t count);
    void clear() noexcept;

private:
    void sort_old();
    std::size_t place_of(const Pair& pair) const;
    std::size_t old_number(std::size_t place) const { return order_.empty() ? place : order_[place]; }

    std::vector<Pair> old_pairs_;
    std::vector<Corners> old_corners_;
    std::vector<std::uint32_t> order_;  // of the old ones, ascending; empty: they are so
};

}  // namespace clinch
