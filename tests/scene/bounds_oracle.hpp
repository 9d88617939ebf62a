// The exact box of a body in long double, written from the definition of each shape and sharing no code with the
// library; and hostile bodies to try bounds on.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "clinch/scene.hpp"
#include "tests/random.hpp"

namespace clinch::test {

using Real = long double;
using Real3 = std::array<Real, 3>;

/// Where the body's z, y or x axis (2, 1, 0) points in the world: q * unit vector * conjugate(q), by two
/// quaternion products.
inline Real3 turned(const Quat& q, const Real3& v) {
    const Real n = std::sqrt(Real(q.w) * q.w + Real(q.x) * q.x + Real(q.y) * q.y + Real(q.z) * q.z);
    const Real w = q.w / n;
    const Real3 u = {q.x / n, q.y / n, q.z / n};
    const auto cross = [](const Real3& a, const Real3& b) {
        return Real3{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    };
    const Real3 t = cross(u, v);
    const Real3 tt = cross(u, t);
    return {v[0] + 2 * (w * t[0] + tt[0]), v[1] + 2 * (w * t[1] + tt[1]), v[2] + 2 * (w * t[2] + tt[2])};
}

/// How far the shape reaches from the body's origin in a direction of the body's own frame (its support).
struct Support {
    Real3 d;
    Real norm() const { return std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]); }
    Real rim() const { return std::sqrt(d[0] * d[0] + d[1] * d[1]); }
    Real along(const Vec3& p) const { return d[0] * p.x + d[1] * p.y + d[2] * p.z; }
    Real operator()(const Sphere& s) const { return s.radius * norm(); }
    Real operator()(const Box& s) const {
        return std::fabs(d[0]) * s.half_extents.x + std::fabs(d[1]) * s.half_extents.y +
               std::fabs(d[2]) * s.half_extents.z;
    }
    Real operator()(const Capsule& s) const { return std::fabs(d[2]) * s.half_height + s.radius * norm(); }
    Real operator()(const Cylinder& s) const { return std::fabs(d[2]) * s.half_height + s.radius * rim(); }
    Real operator()(const Cone& s) const {
        return std::max(d[2] * s.half_height, -d[2] * s.half_height + s.radius * rim());
    }
    Real operator()(const Plane&) const { return INFINITY; }
    Real operator()(const Hull& s) const {
        Real best = -INFINITY;
        for (const Vec3& p : s.points) best = std::max(best, along(p));
        return best;
    }
    Real operator()(const Mesh& s) const {
        Real best = -INFINITY;
        for (const auto& t : s.triangles)
            for (const std::uint32_t v : t) best = std::max(best, along(s.vertices[v]));
        return best;
    }
};

struct ExactBox {
    Real3 min, max;
};

/// The box of the body's shape grown by its margin; relative error about 1e-18.
inline ExactBox exact_box(const Shape& shape, const Body& body) {
    // The support of the turned shape along world axis i is that of the shape along the axis turned back.
    const Quat& q = body.pose.rotation;
    const Quat back{q.w, -q.x, -q.y, -q.z};
    const Real p[3] = {body.pose.position.x, body.pose.position.y, body.pose.position.z};
    ExactBox box{};
    for (std::size_t i = 0; i < 3; ++i) {
        Real3 axis{};
        axis[i] = 1;
        const Real3 d = turned(back, axis);
        box.max[i] = p[i] + (std::visit(Support{d}, shape) + body.margin);
        box.min[i] = p[i] - (std::visit(Support{{-d[0], -d[1], -d[2]}}, shape) + body.margin);
    }
    return box;
}

/// Uniform on the rotations.
inline Quat random_rotation(Random& random) {
    for (;;) {
        const Quat q{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
        const double n = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
        if (n > 0.1 && n <= 1) return {q.w / n, q.x / n, q.y / n, q.z / n};
    }
}

/// Rotations that break careless code: axis to axis, near half turns, tiny, off unit length.
inline Quat hostile_rotation(Random& random) {
    constexpr double h = 0.70710678118654752440;
    const Quat special[] = {{1, 0, 0, 0},    {-1, 0, 0, 0},         {0, 0, 0, 1},     {h, h, 0, 0},
                            {0, h, -h, 0},   {h, 0, 0, h},          {.5, .5, .5, .5}, {.5, -.5, .5, .5},
                            {1, 1e-9, 0, 0}, {1, 1e-20, 0, 1e-300}, {1e-9, 1, 0, 0},  {1e-8, 0, 1e-8, 1},
                            {h, h, 1e-8, 0}, {1, 3e-5, -2e-5, 1e-5}};
    Quat q = random.below(2) == 0 ? special[random.below(std::size(special))] : random_rotation(random);
    const double stretch = random.below(3) == 0 ? 1.0 + random.between(-9.9e-4, 9.9e-4) : 1.0;
    return {q.w * stretch, q.x * stretch, q.y * stretch, q.z * stretch};
}

/// A length within a wide range of magnitudes, now and then one no float32 can hold normally.
inline double hostile_length(Random& random) {
    if (random.below(16) == 0) {
        constexpr double odd[] = {5e-324, 1e-40, 1e-30, 1e-20, 1e10, 1e20, 1e30};
        return odd[random.below(std::size(odd))];
    }
    return std::pow(10.0, random.between(-6, 4));
}

inline std::vector<Vec3> hostile_points(Random& random, std::size_t count) {
    const double size = std::max(hostile_length(random), 1e-40), offset = random.below(2) == 0 ? 0.0 : 30.0 * size;
    std::vector<Vec3> points(count);
    for (Vec3& p : points)
        p = {offset + random.between(-size, size), random.between(-size, size), 1e-3 * random.between(-size, size)};
    return points;
}

/// A shape of class `kind` (not a Plane) with hostile sizes: needles 1000 : 1 : 1 and 1e6 : 1 : 1 among them.
inline Shape hostile_shape(std::size_t kind, Random& random) {
    const double a = hostile_length(random);
    const double ratio[] = {1.0, 1e-3, 1e-6, 0.3, 1e3};
    const double b = std::max(a * ratio[random.below(5)], 5e-324);
    switch (kind) {
        case 0:
            return Sphere{a};
        case 1:
            return random.below(2) == 0 ? Box{{a, b, b}} : Box{{b, a, hostile_length(random)}};
        case 2:
            return Capsule{a, random.below(8) == 0 ? 0.0 : b};
        case 3:
            return Cylinder{a, b};
        case 4:
            return Cone{a, b};
        case 6:
            return Hull{hostile_points(random, 4 + random.below(80))};
        default: {
            Mesh mesh{hostile_points(random, 3 + random.below(80)), {}};
            for (std::uint32_t i = 2; i < mesh.vertices.size(); ++i) mesh.triangles.push_back({0, i - 1, i});
            return mesh;
        }
    }
}

constexpr std::size_t boxed_kinds[] = {0, 1, 2, 3, 4, 6, 7};

/// A body in a hostile place: 1e7 from the origin, at 0, at numbers that are no float32.
inline Body hostile_body(ShapeId shape, Random& random) {
    const double spread[] = {0.0, 1e-6, 1.0, 1e3, 1e7, 1e7, 1e-35, 1e25};
    const double s = spread[random.below(8)];
    Body body;
    body.shape = shape;
    body.pose.position = {random.between(-s, s), random.between(-s, s), s};
    if (random.below(4) == 0) body.pose.position.x = static_cast<float>(body.pose.position.x);
    body.pose.rotation = hostile_rotation(random);
    const double margins[] = {0.0, 0.0, 0.1, 1.0, 1e-45, 1e-7};
    body.margin = margins[random.below(6)];
    return body;
}

/// `count` hostile bodies of all shape classes, each with a shape of its own.
inline Scene hostile_scene(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    Scene scene;
    for (std::size_t i = 0; i < count; ++i) {
        const Shape shape = hostile_shape(boxed_kinds[i % std::size(boxed_kinds)], random);
        scene.add_body(hostile_body(scene.add_shape(shape), random));
    }
    return scene;
}

}  // namespace clinch::test
