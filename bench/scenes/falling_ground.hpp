// What bodies fall on, and how high above it a body lies.
#pragma once

#include <vector>

#include "clinch/pose.hpp"

namespace clinch::scenes {

/// A shape as the ground holds it: the convex hull of `corners` (in the body's frame, at least one), grown by `round`
/// on all sides.
struct Outline {
    std::vector<Vec3> corners;
    double round = 0.0;

    /// The radius of the smallest ball around the body's origin that holds the shape.
    double bound() const;
};

/// The floor z = 0, or, with a radius, the lower half of the inside of a ball that stands on it.
struct Ground {
    double radius = 0.0;

    /// The height at which a body above (x, y) just touches the ground. In a bowl the whole body lies within its
    /// mouth; what reaches out is taken to be at the mouth's edge.
    double height(const Outline& outline, const Quat& rotation, double x, double y) const;
    /// Whether a body of this bound lies within the mouth with a twentieth to spare.
    bool holds(double x, double y, double bound) const;
};

/// How far a body reaches below its origin.
double reach_below(const Outline& outline, const Quat& rotation);

/// Quaternions: a after b, and q at unit length.
Quat product(const Quat& a, const Quat& b);
Quat normalised(const Quat& q);

}  // namespace clinch::scenes
