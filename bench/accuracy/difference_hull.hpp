// The signed distance of any two convex bodies from both sides, in long double, by a hull that grows inside their
// difference. Slow and general: the reference where no closed form and no enumeration of features is at hand.
#pragma once

#include "bench/accuracy/support.hpp"

namespace clinch::accuracy {

/// What is known of a true distance, and a direction that the first bound is worth.
struct Bounds {
    Real low = 0, high = 0;
    Real3 normal{};
};

/// `low` is the pair's separation along `normal`, the best one seen, and so no more than the true distance; `high` the
/// signed distance from a polytope inside the difference of the cores, and so no less. They meet to 2e-15 of the
/// size (2e-14 for bodies of very unlike sizes), but where directions tie (round bodies on one axis) or the polytope
/// ends in slivers. Only of pairs whose cores make a difference with a volume: one of them is neither sphere nor
/// capsule. Cost: some 100 supports of both.
Bounds bounds_of(const Difference& pair);

}  // namespace clinch::accuracy
