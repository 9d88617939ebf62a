// The signed distance of two convex polytopes by trying everything: all faces' normals, all pairs of edges, all pairs
// of features. Shares no code with the library.
#pragma once

#include <vector>

#include "clinch/pose.hpp"

namespace clinch::test {

/// The hull of `points` (any number, also flat ones of up to two points), turned, moved, and swept by a ball.
struct Polytope {
    std::vector<Vec3> points;
    Quat rotation;
    Vec3 position;
    double ball = 0.0;
};

/// The gap, or minus the shortest translation that separates. With 64 bits of mantissa; `careful`: with 113, which is
/// some hundred times slower and needed where edges are nearly parallel.
long double true_distance(const Polytope& a, const Polytope& b, bool careful);

}  // namespace clinch::test
