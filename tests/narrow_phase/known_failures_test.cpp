// What narrow phases are known to get wrong, each with the answer that geometry gives: at every precision, on the host
// and on a device.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "clinch/error.hpp"
#include "clinch/narrow_phase.hpp"
#include "tests/device/devices.hpp"
#include "tests/narrow_phase/known_failures_cases.hpp"

using namespace clinch;
using namespace clinch::test::known;

TEST_CASE("known failures: faces, edges and corners of boxes that touch", "[device][builds]") {
    std::vector<Case> cases;
    for (const double s : {0.01, 1.0, 1000.0})
        for (const Quat& turn : some_turns()) {
            Case face{"face on face", cube(s), {}, cube(s), {{2 * s, 0.3 * s, -0.2 * s}, {}}, 0, {{1, 0, 0}}};
            add_with_hulls(cases, moved(face, turn, {}));
            Case edge{"edge on edge", cube(s), {}, cube(s), {{2 * s, 2 * s, 0.1 * s}, {}}, 0};
            add_with_hulls(cases, moved(edge, turn, {}));
            Case corner{"corner on corner", cube(s), {}, cube(s), {{2 * s, 2 * s, 2 * s}, {}}, 0};
            add_with_hulls(cases, moved(corner, turn, {}));
        }
    check(cases);
}

TEST_CASE("known failures: gaps and depths of 1e-11 to 1e-6", "[device][builds]") {
    std::vector<Case> cases;
    for (const double g : {1e-11, 1e-9, 1e-8, 1e-6, -1e-11, -1e-9, -1e-6}) {
        const double x = 2 + g;
        add_with_hulls(cases, {"cubes", cube(1), {}, cube(1), {{x, 0.25, 0.5}, {}}, x - 2, {{1, 0, 0}}});
        cases.push_back({"sphere, cube", Sphere{1}, {}, cube(1), {{x, 0.25, 0.5}, {}}, x - 2, {{1, 0, 0}}});
        cases.push_back({"cylinder, cube", Cylinder{1, 1}, {}, cube(1), {{0.25, 0.5, x}, {}}, x - 2, {}, 2e-10});
        cases.push_back({"spheres", Sphere{1}, {}, Sphere{1}, {{x, 0, 0}, {}}, x - 2, {{1, 0, 0}}});
        // Lying on its side on a thin plate.
        cases.push_back({"lying cylinder, plate",
                         Box{{2, 2, 0.5}},
                         {},
                         Cylinder{0.5, 1},
                         {{0, 0, 1 + g}, about({1, 0, 0}, pi / 2)},
                         (1 + g) - 1,
                         {},
                         1e-8});
    }
    check(cases);
}

TEST_CASE("known failures: the origin on a face, an edge or a corner of the first polytope", "[device][builds]") {
    const Hull octahedron{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
    std::vector<Case> cases;
    for (const Quat& turn : some_turns()) {
        // Each other's centre on a face, an edge, a corner: the way out is along one axis.
        Case c{"centre on face", cube(1), {}, cube(1), {{1, 0, 0}, {}}, -1, {{1, 0, 0}}};
        add_with_hulls(cases, moved(c, turn, {}));
        c = {"centre on edge", cube(1), {}, cube(1), {{1, 1, 0}, {}}, -1, {{1, 0, 0}, {0, 1, 0}}};
        add_with_hulls(cases, moved(c, turn, {}));
        c = {"centre on corner", cube(1), {}, cube(1), {{1, 1, 1}, {}}, -1, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
        add_with_hulls(cases, moved(c, turn, {}));
        c = {"octahedron about a face's centre", cube(1), {}, octahedron, {{1, 0, 0}, {}}, -1, {{1, 0, 0}}};
        cases.push_back(moved(c, turn, {}));
        c.a = as_hull(cube(1));
        cases.push_back(moved(c, turn, {}));
        c = {"octahedron's tip on a face", cube(1), {}, octahedron, {{2, 0, 0}, {}}, 0, {{1, 0, 0}}};
        cases.push_back(moved(c, turn, {}));
        c = {"ball about a face's centre", Sphere{0.5}, {}, as_hull(cube(1)), {{-1, 0, 0}, {}}, -0.5, {{-1, 0, 0}}};
        cases.push_back(moved(c, turn, {}));
    }
    check(cases);
}

TEST_CASE("known failures: edges that are parallel, or all but", "[device][builds]") {
    std::vector<Case> cases;
    for (const double angle : {0.0, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2})
        for (const double g : {-1e-2, 1e-2}) {
            // Turned about the faces' normal, then out of it: an edge of b comes down.
            Case c{"stack, turned by " + std::to_string(angle),
                   cube(1),
                   {},
                   cube(0.5),
                   {{0.1, 0.2, 1.5 + g}, about({0, 0, 1}, angle)},
                   1.5 + g - 1.5,
                   {{0, 0, 1}},
                   1e-8,
                   2e-3};
            add_with_hulls(cases, c);
            c.what = "stack, tilted by " + std::to_string(angle);
            c.at_b.rotation = about({1, 0, 0}, angle);
            c.distance = 1.5 + g - 1 - 0.5 * (std::cos(angle) + std::sin(angle));
            add_with_hulls(cases, c);
            // Plates that cross, their edges over each other's faces.
            Case plates{"crossed plates, turned by " + std::to_string(angle),
                        Box{{5, 1, 0.05}},
                        {},
                        Box{{1, 5, 0.05}},
                        {{0.25, -0.5, 0.1 + g}, about({0, 0, 1}, angle)},
                        g,
                        {{0, 0, 1}},
                        1e-8,
                        2e-3};
            add_with_hulls(cases, plates);
        }
    for (Case& c : cases) c.normals.resize(c.distance > -0.05 ? c.normals.size() : 0);
    check(cases);
}

TEST_CASE("known failures: bodies about one centre", "[device][builds]") {
    std::vector<Case> cases;
    for (const Quat& turn : some_turns()) {
        std::vector<Case> own;
        own.push_back({"spheres", Sphere{2}, {}, Sphere{2}, {}, -4});
        own.push_back({"sphere, box", Sphere{0.5}, {}, Box{{1, 2, 3}}, {}, -1.5});
        own.push_back({"sphere, capsule", Sphere{0.5}, {}, Capsule{0.25, 1}, {}, -0.75});
        own.push_back({"sphere, cylinder", Sphere{0.5}, {}, Cylinder{1, 2}, {}, -1.5});
        own.push_back({"sphere, flat cylinder", Sphere{0.5}, {}, Cylinder{2, 1}, {}, -1.5, {{0, 0, 1}, {0, 0, -1}}});
        own.push_back({"capsules", Capsule{0.1, 1}, {}, Capsule{0.2, 2}, {}, -0.3});
        own.push_back({"box, capsule", Box{{1, 2, 3}}, {}, Capsule{0.5, 1}, {}, -1.5, {{1, 0, 0}, {-1, 0, 0}}});
        own.push_back({"box, cylinder", Box{{3, 3, 0.5}}, {}, Cylinder{1, 1}, {}, -1.5, {{0, 0, 1}, {0, 0, -1}}, 1e-8});
        own.push_back({"cylinders", Cylinder{1, 2}, {}, Cylinder{0.5, 1}, {}, -1.5, {}, 4e-3, 4e-3});
        own.push_back({"cones", Cone{1, 1}, {}, Cone{1, 1}, {}, -4 / std::sqrt(5.0), {}, 4e-3, 4e-3});
        Case boxes{"boxes", Box{{1, 2, 3}}, {}, Box{{0.5, 0.25, 0.125}}, {}, -1.5, {{1, 0, 0}, {-1, 0, 0}}};
        add_with_hulls(own, boxes);
        Case same{"the same box", Box{{1, 2, 3}}, {}, Box{{1, 2, 3}}, {}, -2, {{1, 0, 0}, {-1, 0, 0}}};
        add_with_hulls(own, same);
        for (const Case& c : own) cases.push_back(moved(c, turn, {}));
    }
    check(cases);
}

TEST_CASE("known failures: one body deep in another", "[device][builds]") {
    std::vector<Case> cases;
    Case corner{"small cube in the corner of a large one", cube(1), {}, cube(0.05), {{0.9, 0.9, 0.9}, {}}, -0.15,
                {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    add_with_hulls(cases, corner);
    for (const double angle : {0.0, 1e-9, 1e-6, 1e-3}) {
        Case plate{"plate in a slab",
                   Box{{2, 2, 0.5}},
                   {},
                   Box{{1, 1, 0.001}},
                   {{0.1, 0.2, 0.4}, about({0, 0, 1}, angle)},
                   -0.101,
                   {{0, 0, 1}},
                   1e-8,
                   1e-3};
        add_with_hulls(cases, plate);
    }
    cases.push_back(
        {"ball below a box's face", Sphere{0.5}, {}, Box{{2, 2, 1}}, {{0, 0, -0.9}, {}}, -0.6, {{0, 0, -1}}});
    cases.push_back({"capsule through a box",
                     cube(1),
                     {},
                     Capsule{0.1, 10},
                     {{0.3, 0.2, 0}, about({0, 1, 0}, pi / 2)},
                     -0.9,
                     {{0, 1, 0}}});
    cases.push_back({"capsule all through a box", cube(1), {}, Capsule{0.1, 10}, {{}, about({0, 1, 0}, pi / 2)}, -1.1});
    check(cases);
}

TEST_CASE("known failures: needles, wafers and plates", "[device][builds]") {
    std::vector<Case> cases;
    for (const double w : {1e-3, 1e-6, 1e-8}) {
        const Hull needle{{{0, 0, 0}, {1, 0, 0}, {1, w, 0}, {1, 0, w}}};
        const Hull wafer{{{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {w, 0.25, 0.25}}};
        for (const double g : {1e-3, 1e-7}) {
            cases.push_back({"needle's tip before a face",
                             cube(1),
                             {},
                             needle,
                             {{1 + g, 0.2, 0.3}, {}},
                             (1 + g) - 1,
                             {{1, 0, 0}},
                             1e-7,
                             1e-2});
            cases.push_back({"wafer on a face",
                             cube(1),
                             {},
                             wafer,
                             {{1 + g, -0.2, -0.3}, {}},
                             (1 + g) - 1,
                             {{1, 0, 0}},
                             1e-7,
                             1e-2});
            Case plates{"plates", Box{{1, 1, w}}, {},   Box{{1, 1, w}}, {{0.5, 0.3, 2 * w + g}, {}},
                        g,        {{0, 0, 1}},    1e-12};
            add_with_hulls(cases, plates);
            cases.push_back(
                {"discs", Cylinder{1, w}, {}, Cylinder{1, w}, {{0.5, 0.3, 2 * w + g}, {}}, g, {}, 1e-8, 1e-3});
        }
        cases.push_back(
            {"needle, ball on its tip", Sphere{0.5}, {}, needle, {{0.75, 0, 0}, {}}, 0.25, {{1, 0, 0}}, 1e-12});
    }
    check(cases);
}

TEST_CASE("known failures: bodies of a millimetre on a box of 500 metres", "[device][builds]") {
    std::vector<Case> cases;
    const Box ground = cube(500);
    const double s = 0.0005;
    for (const double g : {0.0, 1e-3, -1e-4})
        for (const Vec3& at : {Vec3{}, Vec3{123.4, -77.7, 0}}) {
            const Pose above{{at.x, at.y, 500 + s + g}, {}};
            const double truth = above.position.z - 500 - s;
            cases.push_back({"box", ground, {}, cube(s), above, truth, {{0, 0, 1}}});
            cases.push_back({"hull", ground, {}, as_hull(cube(s)), above, truth, {{0, 0, 1}}});
            cases.push_back({"cylinder", ground, {}, Cylinder{s, s}, above, truth, {}, 1e-9});
            cases.push_back({"cone", ground, {}, Cone{s, s}, above, truth, {}, 1e-9});
            cases.push_back({"sphere", Sphere{s}, above, ground, {}, truth, {{0, 0, -1}}});
            cases.push_back({"capsule", ground, {}, Capsule{s / 2, s / 2}, above, truth, {{0, 0, 1}}});
            cases.push_back({"cube on a plane", cube(s), above, Plane{{0, 0, 1}, 500}, {}, truth, {{0, 0, -1}}});
        }
    check(cases);
}

TEST_CASE("known failures: capsules whose axes cross, meet, lie in line or have no length", "[device][builds]") {
    std::vector<Case> cases;
    const Capsule a{0.5, 2}, b{0.25, 1};
    for (const Quat& turn : some_turns()) {
        std::vector<Case> own;
        const auto add = [&](const std::string& what, const Shape& p, const Shape& q, const Pose& at, double distance,
                             std::vector<Vec3> normals = {}) {
            own.push_back({what, p, {}, q, at, distance, std::move(normals)});
        };
        add("crossing", a, b, {{0.5, 0, 0}, about({0, 1, 0}, pi / 2)}, -0.75, {{0, 1, 0}, {0, -1, 0}});
        add("crossing askew", a, b, {{}, about({1, 0, 0}, 1)}, -0.75, {{1, 0, 0}, {-1, 0, 0}});
        add("in line, sharing half a unit", a, b, {{0, 0, 2.5}, {}}, -0.75);
        add("in line, end on end", a, b, {{0, 0, 3}, {}}, -0.75);
        add("in line, apart", a, b, {{0, 0, 4}, {}}, 0.25, {{0, 0, 1}});
        add("side by side", a, b, {{0.75, 0, 0.3}, {}}, 0, {{1, 0, 0}});
        add("side by side, apart", a, b, {{1, 0, 1.7}, {}}, 0.25, {{1, 0, 0}});
        add("end before a side", a, b, {{1.75, 0, 0}, about({0, 1, 0}, pi / 2)}, 0, {{1, 0, 0}});
        add("no length", a, Capsule{0.25, 0}, {{1, 0, 1}, {}}, 0.25, {{1, 0, 0}});
        add("no length, on the axis", a, Capsule{0.25, 0}, {{0, 0, 1}, {}}, -0.75);
        add("neither has length", Capsule{0.5, 0}, Capsule{0.25, 0}, {{0.5, 0, 0}, {}}, -0.25, {{1, 0, 0}});
        add("neither has length, one centre", Capsule{0.5, 0}, Capsule{0.25, 0}, {}, -0.75);
        add("sphere on the axis", Sphere{0.25}, a, {{0, 0, 1}, {}}, -0.75);
        add("box's edge, parallel", cube(1), Capsule{0.1, 0.5}, {{1.25, 1.25, 0.2}, {}}, 0.25 * std::sqrt(2.0) - 0.1,
            {{std::sqrt(0.5), std::sqrt(0.5), 0}});
        add("box's face, parallel", cube(1), Capsule{0.1, 0.5}, {{1.05, 0.3, 0.2}, {}}, -0.05, {{1, 0, 0}});
        add("no length, in a box", cube(1), Capsule{0.1, 0}, {{0.8, 0, 0}, {}}, -0.3, {{1, 0, 0}});
        for (const Case& c : own) cases.push_back(moved(c, turn, {}));
    }
    for (double angle = 1e-9; angle < 0.02; angle *= 10)
        cases.push_back({"crossing at a small angle",
                         Capsule{0.1, 3},
                         {},
                         Capsule{0.2, 2},
                         {{0, 1e-2, 0.7}, about({0, 1, 0}, angle)},
                         1e-2 - 0.3,
                         {{0, 1, 0}}});
    check(cases);
}

TEST_CASE("known failures: a cone's apex and rim", "[device][builds]") {
    std::vector<Case> cases;
    const Cone cone{0.5, 1};
    const Quat upside_down = about({1, 0, 0}, pi);
    for (const double g : {0.1, 1e-6, -1e-3}) {
        cases.push_back(
            {"apex on a face", Box{{2, 2, 1}}, {}, cone, {{0.1, 0.2, 2 + g}, upside_down}, g, {}, 2e-9, 1e-3});
        cases.push_back({"base on a face", Box{{2, 2, 1}}, {}, cone, {{0.1, 0.2, 2 + g}, {}}, g, {}, 2e-9, 1e-3});
        cases.push_back({"apex over a plane", cone, {{0, 0, 1 + g}, upside_down}, Plane{}, {}, g, {{0, 0, -1}}});
        cases.push_back({"base over a plane", cone, {{3, 4, 1 + g}, {}}, Plane{}, {}, g, {{0, 0, -1}}});
        cases.push_back({"ball over the apex", Sphere{0.5}, {{0, 0, 1.5 + g}, {}}, cone, {}, g, {{0, 0, -1}}});
        cases.push_back({"ball beside the rim", Sphere{0.5}, {{1 + g, 0, -1}, {}}, cone, {}, g, {{-1, 0, 0}}});
        cases.push_back({"ball under the base", Sphere{0.5}, {{0.1, 0, -1.5 - g}, {}}, cone, {}, g, {{0, 0, 1}}});
        cases.push_back({"base on base", cone, {}, cone, {{0.1, 0, -2 - g}, upside_down}, g, {}, 4e-9, 2e-3});
        cases.push_back(
            {"apex on a hull", as_hull(Box{{2, 2, 1}}), {}, cone, {{0.1, 0.2, 2 + g}, upside_down}, g, {}, 2e-9, 1e-3});
    }
    // Depth of a tip is that of its tip only while the other is blunt.
    cases.push_back({"apex on apex", cone, {}, cone, {{0, 0, 2.1}, upside_down}, 0.1, {{0, 0, 1}}, 1e-9, 1e-3});
    cases.push_back({"ball on the apex", Sphere{0.5}, {{0, 0, 1}, {}}, cone, {}, -0.5});
    check(cases);
}

TEST_CASE("known failures: repeated and coplanar points of hulls", "[device][builds]") {
    Hull busy = as_hull(cube(1));
    for (int i = 0; i < 8; ++i) busy.points.push_back(busy.points[static_cast<std::size_t>(i)]);
    for (int u = -3; u <= 3; ++u)
        for (int v = -3; v <= 3; ++v)
            for (const double side : {1.0, -1.0}) {
                const double x = u / 3.0, y = v / 3.0;
                busy.points.push_back({x, y, side});
                busy.points.push_back({y, side, x});
                busy.points.push_back({side, x, y});
            }
    busy.points.push_back({0.1, 0.2, 0.3});  // within
    std::vector<Case> cases;
    for (const Quat& turn : some_turns())
        for (const double x : {2.5, 2.0, 1.0}) {
            const Pose at{{x, 0.25, -0.125}, {}};
            const std::vector<Vec3> normals{{1, 0, 0}};
            cases.push_back(moved({"two hulls", busy, {}, busy, at, x - 2, normals}, turn, {}));
            cases.push_back(moved({"hull, cube", cube(1), {}, busy, at, x - 2, normals}, turn, {}));
            cases.push_back(moved({"hull, sphere", Sphere{1}, {}, busy, at, x - 2, normals}, turn, {}));
            cases.push_back(moved({"hull, capsule", Capsule{1, 0.25}, {}, busy, at, x - 2, normals}, turn, {}));
            cases.push_back(moved({"hull, plane", Plane{{1, 0, 0}, 1}, {}, busy, at, x - 2, normals}, turn, {}));
            cases.push_back(moved({"hull, cylinder", Cylinder{1, 1}, {}, busy, at, x - 2, {}, 2e-8, 1e-3}, turn, {}));
        }
    // Hulls that share a corner, prisms flush top and bottom.
    const Hull tetrahedron{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    cases.push_back({"sharing a corner", tetrahedron, {}, tetrahedron, {{}, about({1, -1, 0}, pi)}, 0});
    cases.push_back(
        {"flush boxes", as_hull(Box{{1, 1, 0.5}}), {}, as_hull(Box{{0.25, 1, 0.5}}), {{1.25, 0, 0}, {}}, 0});
    check(cases);
}

TEST_CASE("known failures: far from the world's origin", "[device][builds]") {
    std::vector<Case> cases;
    for (const double far : {1e5, 1e6}) {
        const Vec3 by{far, -far, far / 2};
        const Quat none;
        Case boxes{"boxes", cube(0.5), {}, cube(0.5), {{1.0078125, 0.25, 0}, {}}, 0.0078125, {{1, 0, 0}}};
        cases.push_back(moved(boxes, none, by));
        cases.push_back(moved(
            {"spheres", Sphere{0.5}, {}, Sphere{0.5}, {{1.0078125, 0, 0}, {}}, 0.0078125, {{1, 0, 0}}}, none, by));
        cases.push_back(moved(
            {"capsules", Capsule{0.5, 1}, {}, Capsule{0.5, 1}, {{0.9921875, 0, 0.5}, {}}, -0.0078125, {{1, 0, 0}}},
            none, by));
        cases.push_back(moved(
            {"hulls", as_hull(cube(0.5)), {}, as_hull(cube(0.5)), {{0.9921875, 0.25, 0}, {}}, -0.0078125, {{1, 0, 0}}},
            none, by));
        cases.push_back(
            moved({"cylinder, box", cube(0.5), {}, Cylinder{0.5, 0.5}, {{0.25, 0, 1.0078125}, {}}, 0.0078125, {}, 1e-9},
                  none, by));
        // Far along the plane, too.
        cases.push_back(
            {"sphere, plane", Sphere{0.5}, {{far, far, 0.5078125}, {}}, Plane{}, {}, 0.0078125, {{0, 0, -1}}});
    }
    check(cases);
}

TEST_CASE("known failures: sizes too small to square, and denormal ones", "[device][builds]") {
    std::vector<Case> cases;
    for (const double s : {1e-12, 1e-25, 1e-30, 1e-42, 1e-160, 1e-310}) {
        cases.push_back({"spheres", Sphere{s}, {}, Sphere{s}, {{3 * s, 0, 0}, {}}, s});
        cases.push_back({"boxes", cube(s), {}, cube(s), {{1.5 * s, 0, 0}, {}}, -0.5 * s});
        cases.push_back({"capsules", Capsule{s, s}, {}, Capsule{s, 0}, {{s, 0, 0}, {}}, -s});
        cases.push_back({"sphere, box", Sphere{s}, {}, cube(s), {{0, 3 * s, 0}, {}}, s});
        cases.push_back({"sphere, plane", Sphere{s}, {{0, 0, 2 * s}, {}}, Plane{}, {}, s});
        cases.push_back({"cylinders", Cylinder{s, s}, {}, Cylinder{s, s}, {{0, 0, 3 * s}, {}}, s, {}, 1e-8});
        if (s > 1e-300) cases.push_back({"hulls", as_hull(cube(s)), {}, as_hull(cube(s)), {{3 * s, 0, 0}, {}}, s});
        // Nothing beside a body of common size.
        cases.push_back({"a speck on a ball", Sphere{1}, {}, Sphere{s}, {{1.5, 0, 0}, {}}, 0.5 - s, {{1, 0, 0}}});
        cases.push_back({"a speck in a box", cube(1), {}, cube(s), {{0.75, 0, 0}, {}}, -0.25 - s, {{1, 0, 0}}});
    }
    check(cases);
}

TEST_CASE("known failures: margins of any size change no answer", "[device][builds]") {
    Context context = test::with_lanes(0, list_devices()[0].lanes);
    for (const double margin : {0.0, 1e-3, 1.0, 1e2, 1e4}) {
        Scene scene;
        Body body;
        body.margin = margin;
        body.shape = scene.add_shape(Sphere{0.5});
        scene.add_body(body);
        body.shape = scene.add_shape(Box{{1, 1, 1}});
        body.pose.position = {1.49, 0.25, 0};
        scene.add_body(body);
        const std::vector<Pair> pairs(200, Pair{0, 1});
        for (const double precision : {0.0, 0.5, 1.0}) {
            NarrowPhaseOptions options;
            options.precision = precision;
            NarrowPhase narrow(context, options);
            INFO("margin " << margin << ", precision " << precision);
            for (const Contact& c : narrow.find(scene, pairs)) {
                CHECK(std::fabs(c.distance + 0.01) <= c.error + 1e-15);
                CHECK(c.normal.x > 1 - 1e-6);
            }
        }
    }
}

TEST_CASE("known failures: what has no size or no number is refused by name", "[host]") {
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
    std::vector<Shape> shapes{Sphere{0},
                              Sphere{nan},
                              Box{{1, 0, 1}},
                              Capsule{0, 1},
                              Capsule{1, -1},
                              Cylinder{1, 0},
                              Cone{0, 1},
                              Cone{1, infinite},
                              Plane{{0, 0, 0}, 0},
                              Hull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
                              Hull{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}},
                              Hull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5, 0.5, 0}}},
                              Hull{{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}}}};
    std::vector<Pose> poses(shapes.size());
    for (const Pose& pose : {Pose{{nan, 0, 0}, {}}, Pose{{0, infinite, 0}, {}}, Pose{{}, {0, 0, 0, 0}},
                             Pose{{}, {1.01, 0, 0, 0}}, Pose{{}, {nan, 0, 0, 0}}}) {
        shapes.emplace_back(Sphere{1});
        poses.push_back(pose);
    }
    Context host = Context::host_only();
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        INFO("shape " << i);
        Scene scene;
        Body body;
        body.shape = scene.add_shape(Sphere{1});
        scene.add_body(body);
        body.shape = scene.add_shape(shapes[i]);
        body.pose = poses[i];
        scene.add_body(body);
        REQUIRE(scene.rejected().size() == 1);
        CHECK(scene.rejected()[0].body == 1);
        CHECK_FALSE(scene.rejected()[0].why.empty());
        const std::vector<Pair> pairs{{0, 1}};
        NarrowPhase narrow(host);
        CHECK_THROWS_AS(narrow.find(scene, pairs), Error);
    }
}

TEST_CASE("known failures: rotations a little off unit length are those of unit length", "[device][builds]") {
    std::vector<Case> cases;
    const double k = 1.0009;
    const Quat q = about({0, 0, 1}, 0.3);
    const Pose at{{0.1, 0.2, 2.5}, {q.w * k, q.x * k, q.y * k, q.z * k}};
    add_with_hulls(cases, {"boxes", cube(1), {}, cube(1), at, 0.5, {{0, 0, 1}}});
    cases.push_back({"cylinder, box", cube(1), {}, Cylinder{1, 1}, at, 0.5, {}, 1e-9});
    cases.push_back({"capsule, plane", Capsule{1, 1}, {{0, 0, 2.5}, at.rotation}, Plane{}, {}, 0.5, {{0, 0, -1}}});
    check(cases);
}

TEST_CASE("known failures: what rounding bends out of shape", "[device][builds]") {
    std::vector<Case> cases;
    // Seen all but along its axis, a disc's rim lies where squares of floats vanish.
    cases.push_back({"capsule at a cylinder's side",
                     Cylinder{1.8568579257896143, 3},
                     {},
                     Capsule{0.0088032862417779089, 1.7019984996987116e-05},
                     {{-1.8568579257896138, 0, -0.03241402193471752},
                      {6.1232339779452335e-17, -7.6230934362572469e-05, 0.99999999709442233, -4.6677984881568176e-21}},
                     -0.0088032862417779089,
                     {},
                     1e-9});
    // So little apart that the square of the way between them is next to no number.
    cases.push_back({"a speck in the middle of a cylinder",
                     Cylinder{0.068752784637705441, 1},
                     {},
                     Capsule{5.6354771177571296e-09, 0},
                     {{7.479093777160556e-21, -9.7513815415703476e-29, -1.4676408912288237e-28},
                      {1, 3.6105684328084202e-09, 9.8116224467585935e-09, -6.5190930112007809e-09}},
                     -0.0687527902731825581,
                     {},
                     4e-3,
                     4e-3});
    // A simplex that claims to enclose the origin is a sliver, and the point its parts make is far from it.
    cases.push_back({"capsule on a thin box",
                     Box{{3, 0.010357611921627829, 1.1824211487948961}},
                     {{61820.957026902557, 34857.129672647185, -3229113.1596183698},
                      {-0.89627244940157913, -0.14796268983371652, 0.36711452708387143, -0.20007414341901095}},
                     Capsule{0.0026317493885038012, 0.0026317493885038012},
                     {{61823.618808866901, 34858.35653523072, -3229111.8199922098},
                      {-0.89622817349164707, -0.14832695662853307, 0.36700011758365042, -0.20021260867070789}},
                     -0.00263179146203,
                     {}});
    check(cases);
}
