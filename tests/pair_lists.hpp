// Lists of pairs, as tests compare them.
#pragma once

#include <algorithm>
#include <iterator>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/view.hpp"

namespace clinch::test {

inline std::vector<Pair> copy(View<const Pair> pairs) {
    return {pairs.begin(), pairs.end()};
}

/// The pairs of `all` that are not in `some`; both ascending.
inline std::vector<Pair> without(const std::vector<Pair>& all, const std::vector<Pair>& some) {
    std::vector<Pair> rest;
    std::set_difference(all.begin(), all.end(), some.begin(), some.end(), std::back_inserter(rest));
    return rest;
}

}  // namespace clinch::test
