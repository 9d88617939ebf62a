// One list of pairs from sorted lists of keys.
#pragma once

#include <vector>

#include "src/broad_phase/pair_list.hpp"
#include "src/primitives/pair_keys.hpp"

namespace clinch::detail {

/// Appends the pairs of all lists, of the same layout, to `out` (which keeps them), ascending; those that several lists
/// have come once. `disjoint`: no two lists have one in common. On the host's threads: one read of the keys, one write
/// of the pairs, past the caches where those are many.
void merge_keys(const std::vector<PairKeys>& lists, bool disjoint, PairList& out);

}  // namespace clinch::detail
