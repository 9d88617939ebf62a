// What came and what went between two lists of pairs.
#pragma once

#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/view.hpp"

namespace clinch::detail {

/// Keeps the last list, and the pairs by which the next differs from it.
class PairEvents {
public:
    /// `now`, ascending, takes the place of the last list. Cost: one pass over both lists, and a copy if they differ.
    void update(View<const Pair> now);
    /// The list is the last one again.
    void same_again() noexcept {
        added_.clear();
        removed_.clear();
    }
    /// As if no list had been seen: all of the next are added.
    void start_afresh() {
        last_.clear();
        same_again();
    }
    std::size_t host_bytes() const noexcept {
        return (last_.capacity() + added_.capacity() + removed_.capacity()) * sizeof(Pair);
    }
    View<const Pair> added() const noexcept { return added_; }      ///< ascending
    View<const Pair> removed() const noexcept { return removed_; }  ///< ascending

private:
    std::vector<Pair> last_, added_, removed_;
};

}  // namespace clinch::detail
