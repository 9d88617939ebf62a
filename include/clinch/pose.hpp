// Where a body is: float64 position and rotation.
#pragma once

#include <type_traits>

namespace clinch {

/// Three coordinates in float64; a point or direction, in world or body space as its user says.
struct Vec3 {
    double x = 0.0, y = 0.0, z = 0.0;
};

/// A rotation as a quaternion w + xi + yj + zk, in float64. Within 1e-3 of unit length it is
/// normalised when used; a body whose quaternion is further off is rejected.
struct Quat {
    double w = 1.0, x = 0.0, y = 0.0, z = 0.0;
};

/// Body to world: first rotated, then moved. A point p of the body is at rotation * p + position.
struct Pose {
    Vec3 position{};
    Quat rotation{};
};

static_assert(sizeof(Vec3) == 24 && sizeof(Quat) == 32, "bulk setters copy arrays of numbers over these");

}  // namespace clinch
