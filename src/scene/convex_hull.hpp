// Which of many points matter to a convex hull.
#pragma once

#include <cstddef>
#include <vector>

#include "clinch/pose.hpp"

namespace clinch::detail {

/// True when the points span a volume: some four of them do not lie in one plane to within what
/// rounding the coordinates to float64 may move them (64 units of 2^-53 of the largest coordinate).
/// All coordinates are finite. O(n).
bool spans_volume(const std::vector<Vec3>& points);

/// The points without exact duplicates and without those proved to lie inside the hull of the others:
/// the two sets have the same convex hull. Ascending by x, y, z. All coordinates are finite. Points
/// that Qhull cannot handle (all in a plane) come back all. O(n log n) when most points are inside
/// by a margin, at worst n times the number of the hull's facets.
std::vector<Vec3> outermost_points(std::vector<Vec3> points);

}  // namespace clinch::detail
