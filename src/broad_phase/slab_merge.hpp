// One list of pairs from those of slabs.
#pragma once

#include <cstdint>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/view.hpp"
#include "src/broad_phase/pair_list.hpp"
#include "src/broad_phase/slabs.hpp"

namespace clinch::detail {

/// What was found in slab s: pairs of places in deal.members(s), a < b, or, if they are named, of boxes; those may come
/// as keys in place of pairs.
struct SlabList {
    View<const Pair> pairs;
    bool named = false;
    bool in_range = false;  ///< only such as belong to slab s
    PairKeys keys;
};
using SlabLists = std::vector<SlabList>;

/// Appends the pairs of all slabs to `out` (which keeps them), each once, as numbers of boxes; ascending if `sorted`,
/// as the lists then must be. On the host's threads: two reads of the lists, one write of the result; one read if all
/// are keys of the same layout.
void merge_slabs(const SlabDeal& deal, const SlabLists& lists, bool sorted, PairList& out);

}  // namespace clinch::detail
