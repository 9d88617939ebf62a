// What came and what went between two lists of pairs.
#pragma once

#include <utility>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/view.hpp"

namespace clinch::detail {

/// Keeps the last list, and the pairs by which the next differs from it.
class PairEvents {
public:
    /// `now`, ascending, takes the place of the last list. Cost: one pass over both lists, and a copy if they differ.
    void update(View<const Pair> now);
    /// The next list is the last one with `added` and without `removed`, both ascending. Costs their size; the last
    /// list is then not known here any more, and hold() is to come before update().
    void change(View<const Pair> added, View<const Pair> removed) {
        added_.assign(added.begin(), added.end());
        removed_.assign(removed.begin(), removed.end());
        std::vector<Pair>().swap(last_);
        behind_ = true;
    }
    /// Whether the last list is not known here.
    bool behind() const noexcept { return behind_; }
    /// Tells the last list.
    void hold(std::vector<Pair> last) noexcept {
        last_ = std::move(last);
        behind_ = false;
    }
    /// The list is the last one again.
    void same_again() noexcept {
        added_.clear();
        removed_.clear();
    }
    /// As if no list had been seen: all of the next are added.
    void start_afresh() {
        last_.clear();
        behind_ = false;
        same_again();
    }
    std::size_t host_bytes() const noexcept {
        return (last_.capacity() + added_.capacity() + removed_.capacity()) * sizeof(Pair);
    }
    View<const Pair> added() const noexcept { return added_; }      ///< ascending
    View<const Pair> removed() const noexcept { return removed_; }  ///< ascending

private:
    std::vector<Pair> last_, added_, removed_;
    bool behind_ = false;
};

}  // namespace clinch::detail
