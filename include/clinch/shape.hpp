// Shape parameters: plain structs, float64, lengths in the scene's unit, each in its body's own frame.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "clinch/pose.hpp"

namespace clinch {

/// A ball around the body's origin. radius > 0.
struct Sphere {
    double radius = 0.5;
};

/// A box around the body's origin with faces along the body's axes. Each half extent > 0.
struct Box {
    Vec3 half_extents{0.5, 0.5, 0.5};
};

/// All points within `radius` of the segment from (0, 0, -half_height) to (0, 0, half_height).
/// radius > 0, half_height >= 0 (0 is a sphere).
struct Capsule {
    double radius = 0.5;
    double half_height = 0.5;
};

/// A solid cylinder around the body's z axis from -half_height to half_height. Both > 0.
struct Cylinder {
    double radius = 0.5;
    double half_height = 0.5;
};

/// A solid cone around the body's z axis: apex at +half_height, base disc at -half_height. Both > 0.
struct Cone {
    double radius = 0.5;
    double half_height = 0.5;
};

/// The half-space normal . x <= offset in the body's frame. The normal is within 1e-3 of unit
/// length. A body with this shape counts as static whatever its motion says, has no box, and
/// never pairs with another plane; it pairs with a body whose box reaches into it.
struct Plane {
    Vec3 normal{0.0, 0.0, 1.0};
    double offset = 0.0;
};

/// The convex hull of at least four points that do not lie in one plane.
struct Hull {
    std::vector<Vec3> points;
};

/// Triangles over vertices; at least one triangle, each index below vertices.size(). Vertices that no
/// triangle uses must be finite and are otherwise ignored.
struct Mesh {
    std::vector<Vec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Any shape. The index of the alternative is the class number kernels use.
using Shape = std::variant<Sphere, Box, Capsule, Cylinder, Cone, Plane, Hull, Mesh>;

/// Names a shape of one Scene; shapes are shared by any number of bodies.
struct ShapeId {
    std::uint32_t index = 0;
};

/// Why `shape` can bear no body, as one clause ("radius is -1 and must be > 0"), or empty if it can.
/// Cost: linear in the shape's numbers. Points of a Hull lie in one plane when none is farther from it
/// than rounding their coordinates to float64 may have moved it (7e-15 of the largest coordinate).
std::string why_invalid(const Shape& shape);

}  // namespace clinch
