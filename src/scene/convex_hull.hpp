// Which of many points matter to a convex hull.
#pragma once

#include <cstddef>
#include <cstdint>
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

/// A face of a convex hull.
struct HullFace {
    Vec3 normal;                         ///< unit length, outward
    double thickness;                    ///< no corner is farther below the plane through the highest than this
    std::vector<std::uint32_t> corners;  ///< numbers of points, counterclockwise seen from outside; at least 3
};

/// The faces of the hull of `points`. Triangles whose planes rounding to float32 may have turned apart make one face:
/// it then has a thickness. Points that Qhull cannot handle have no faces. All coordinates are finite.
std::vector<HullFace> hull_faces(const std::vector<Vec3>& points);

}  // namespace clinch::detail
