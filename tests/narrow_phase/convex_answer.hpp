// Asks the general convex routine, in the numbers of the shim included before: its name for the namespace is
// REAL_NAMESPACE. Rounds the inputs as a device's scene does.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "tests/narrow_phase/convex_cases.hpp"

namespace clinch::detail::REAL_NAMESPACE {
#include "cl/narrow_phase/convex.clh"

/// A side and the vertices it points to.
struct ConvexSide {
    Side side{};
    std::vector<real> vertices;
};

inline void turn_into(const Quat& q, Turn& turn) {
    const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    const double w = q.w / length, x = q.x / length, y = q.y / length, z = q.z / length;
    const double m[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                         2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    for (std::size_t i = 0; i < 9; ++i) turn.m[i] = static_cast<real>(m[i]);
}

inline void hold(const test::ConvexBody& body, ConvexSide& held) {
    for (std::size_t d = 0; d < 3; ++d) held.side.size[d] = static_cast<real>(body.size[d]);
    turn_into(body.rotation, held.side.turn);
    const std::size_t count = body.points.size(), stride = (count + 15) / 16 * 16;
    for (const auto coordinate : {&Vec3::x, &Vec3::y, &Vec3::z})
        for (std::size_t i = 0; i < stride; ++i)
            held.vertices.push_back(static_cast<real>(body.points[std::min(i, count - 1)].*coordinate));
    held.side.vertices = held.vertices.data();
    held.side.vertex_count = static_cast<uint>(count);
    held.side.stride = static_cast<uint>(stride);
}

inline test::ConvexAnswer in_double(const Touch& touch) {
    return {
        static_cast<double>(touch.distance),
        static_cast<double>(touch.error),
        {static_cast<double>(touch.normal.x), static_cast<double>(touch.normal.y), static_cast<double>(touch.normal.z)},
        {static_cast<double>(touch.point.x), static_cast<double>(touch.point.y), static_cast<double>(touch.point.z)}};
}

inline v3 way_between(const test::ConvexBodies& pair) {
    const Vec3 &p = pair.a.position, &q = pair.b.position;
    return v_of(static_cast<real>(q.x - p.x), static_cast<real>(q.y - p.y), static_cast<real>(q.z - p.z));
}

inline test::ConvexAnswer convex_answer(const test::ConvexBodies& pair) {
    ConvexSide a, b;
    hold(pair.a, a);
    hold(pair.b, b);
    Touch touch{};
    touch.limit = std::numeric_limits<real>::max();
    touch_convex_of(pair.a.kind, pair.b.kind, &a.side, &b.side, way_between(pair), &touch);
    return in_double(touch);
}

/// With a limit and a tolerance of its own.
inline test::ConvexAnswer convex_answer(const test::ConvexBodies& pair, double limit, double tolerance) {
    ConvexSide a, b;
    hold(pair.a, a);
    hold(pair.b, b);
    Touch touch{};
    touch.limit = std::numeric_limits<real>::max();
    touch_convex_within(pair.a.kind, pair.b.kind, &a.side, &b.side, way_between(pair), static_cast<real>(limit),
                        static_cast<real>(tolerance), &touch);
    return in_double(touch);
}

}  // namespace clinch::detail::REAL_NAMESPACE
