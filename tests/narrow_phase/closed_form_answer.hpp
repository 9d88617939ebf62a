// Asks a closed form, in the numbers of the shim included before: its name for the namespace is REAL_NAMESPACE. Rounds
// the inputs as a device's scene does.
#pragma once

#include <limits>

#include "tests/narrow_phase/closed_form_cases.hpp"

namespace clinch::detail::REAL_NAMESPACE {
#include "cl/narrow_phase/box_box.clh"
#include "cl/narrow_phase/box_plane.clh"
#include "cl/narrow_phase/capsule_capsule.clh"
#include "cl/narrow_phase/capsule_plane.clh"
#include "cl/narrow_phase/cone_plane.clh"
#include "cl/narrow_phase/cylinder_plane.clh"
#include "cl/narrow_phase/plane_hull.clh"
#include "cl/narrow_phase/sphere_box.clh"
#include "cl/narrow_phase/sphere_capsule.clh"
#include "cl/narrow_phase/sphere_cone.clh"
#include "cl/narrow_phase/sphere_cylinder.clh"
#include "cl/narrow_phase/sphere_plane.clh"
#include "cl/narrow_phase/sphere_sphere.clh"

using Routine = void (*)(const Side*, const Side*, v3, Touch*);

inline Routine routine_of(test::Kind a, test::Kind b) {
    using test::Kind;
    switch (a) {
        case Kind::sphere:
            switch (b) {
                case Kind::sphere:
                    return touch_sphere_sphere;
                case Kind::box:
                    return touch_sphere_box;
                case Kind::capsule:
                    return touch_sphere_capsule;
                case Kind::cylinder:
                    return touch_sphere_cylinder;
                case Kind::cone:
                    return touch_sphere_cone;
                case Kind::plane:
                    return touch_sphere_plane;
                default:
                    return nullptr;
            }
        case Kind::box:
            return b == Kind::box ? touch_box_box : b == Kind::plane ? touch_box_plane : nullptr;
        case Kind::capsule:
            return b == Kind::capsule ? touch_capsule_capsule : b == Kind::plane ? touch_capsule_plane : nullptr;
        case Kind::cylinder:
            return b == Kind::plane ? touch_cylinder_plane : nullptr;
        case Kind::cone:
            return b == Kind::plane ? touch_cone_plane : nullptr;
        case Kind::plane:
            return b == Kind::hull ? touch_plane_hull : nullptr;
        default:
            return nullptr;
    }
}

/// A side and the vertices it points to.
struct HeldSide {
    Side side{};
    std::vector<real> vertices;
};

inline void hold(const test::TrueBody& body, HeldSide& held) {
    const auto axis = test::axes(body);
    const auto plane = test::unit_plane(body);
    for (std::size_t d = 0; d < 3; ++d) {
        held.side.size[d] = static_cast<real>(body.size[d]);
        for (std::size_t i = 0; i < 3; ++i) held.side.turn.m[3 * d + i] = static_cast<real>(axis[i][d]);
    }
    if (body.kind == test::Kind::plane) {
        held.side.size[0] = static_cast<real>(plane[3]);
        held.side.normal = v_of(static_cast<real>(plane[0]), static_cast<real>(plane[1]), static_cast<real>(plane[2]));
    }
    const std::size_t n = body.points.size(), stride = (n + 15) / 16 * 16;
    for (std::size_t d = 0; d < 3; ++d)
        for (std::size_t i = 0; i < stride; ++i)
            held.vertices.push_back(static_cast<real>(body.points[i < n ? i : n - 1][d]));
    held.side.vertices = held.vertices.data();
    held.side.vertex_count = static_cast<uint>(n);
    held.side.stride = static_cast<uint>(stride);
}

/// A coordinate of the way between two positions, as the driver takes it; *slack as there.
inline real way_between(double a, double b, double* slack) {
    if constexpr (sizeof(real) == sizeof(double)) return static_cast<real>(b - a);
    const float high_a = static_cast<float>(a), high_b = static_cast<float>(b);
    const float low_a = static_cast<float>(a - static_cast<double>(high_a));
    const float low_b = static_cast<float>(b - static_cast<double>(high_b));
    *slack = std::fmax(*slack, 0x1p-46 * (std::fabs(a) + std::fabs(b)));
    return static_cast<real>((high_b - high_a) + (low_b - low_a));
}

inline test::Answer answer(const test::TruePair& pair) {
    HeldSide a, b;
    hold(pair.a, a);
    hold(pair.b, b);
    double slack = 0;
    real way[3];
    for (std::size_t d = 0; d < 3; ++d) way[d] = way_between(pair.a.position[d], pair.b.position[d], &slack);
    Touch touch{};
    touch.limit = std::numeric_limits<real>::max();
    routine_of(pair.a.kind, pair.b.kind)(&a.side, &b.side, v_of(way[0], way[1], way[2]), &touch);
    test::Answer answer;
    answer.distance = static_cast<double>(touch.distance);
    answer.error = static_cast<double>(touch.error) + 2 * slack + 1e-37;
    answer.normal = {static_cast<double>(touch.normal.x), static_cast<double>(touch.normal.y),
                     static_cast<double>(touch.normal.z)};
    answer.point = {static_cast<double>(touch.point.x), static_cast<double>(touch.point.y),
                    static_cast<double>(touch.point.z)};
    return answer;
}

}  // namespace clinch::detail::REAL_NAMESPACE
