// What narrow phases are known to get wrong, each with the answer that geometry gives: at every precision, on the host
// and on a device.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "clinch/error.hpp"
#include "clinch/narrow_phase.hpp"
#include "tests/device/devices.hpp"

using namespace clinch;

namespace {

constexpr double pi = 3.14159265358979323846;

struct Case {
    std::string what;
    Shape a;
    Pose at_a;
    Shape b;
    Pose at_b;
    double distance = 0;          // the true one
    std::vector<Vec3> normals{};  // one of which it is; empty: none is told
    double error = 1e-13;         // of the pair's size, that float64 may promise at most
    double error32 = 1e-4;        // the same for float32
};

double length(const Vec3& v) {
    return std::hypot(v.x, v.y, v.z);
}

double reach_of(const Shape& shape) {
    struct Reach {
        double operator()(const Sphere& s) const { return s.radius; }
        double operator()(const Box& s) const { return length(s.half_extents); }
        double operator()(const Capsule& s) const { return s.radius + s.half_height; }
        double operator()(const Cylinder& s) const { return std::hypot(s.radius, s.half_height); }
        double operator()(const Cone& s) const { return std::hypot(s.radius, s.half_height); }
        double operator()(const Plane& s) const { return std::fabs(s.offset); }
        double operator()(const Hull& s) const {
            double most = 0;
            for (const Vec3& p : s.points) most = std::max(most, length(p));
            return most;
        }
        double operator()(const Mesh&) const { return 0; }
    };
    return std::visit(Reach{}, shape);
}

double size_of(const Case& c) {
    const Vec3 &p = c.at_a.position, &q = c.at_b.position;
    return reach_of(c.a) + reach_of(c.b) + length({q.x - p.x, q.y - p.y, q.z - p.z});
}

Quat about(const Vec3& axis, double angle) {
    const double s = std::sin(angle / 2) / length(axis);
    return {std::cos(angle / 2), axis.x * s, axis.y * s, axis.z * s};
}

// The frame's directions and places, turned by q.
Vec3 turned(const Quat& q, const Vec3& v) {
    const Vec3 u{q.x, q.y, q.z};
    const auto cross = [](const Vec3& a, const Vec3& b) {
        return Vec3{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    };
    const Vec3 t = cross(u, v), s = cross(u, t);
    return {v.x + 2 * (q.w * t.x + s.x), v.y + 2 * (q.w * t.y + s.y), v.z + 2 * (q.w * t.z + s.z)};
}

Quat product(const Quat& a, const Quat& b) {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

// A case whose bodies are both turned and moved.
Case moved(Case c, const Quat& turn, const Vec3& by) {
    for (Pose* pose : {&c.at_a, &c.at_b}) {
        const Vec3 p = turned(turn, pose->position);
        *pose = {{p.x + by.x, p.y + by.y, p.z + by.z}, product(turn, pose->rotation)};
    }
    for (Vec3& n : c.normals) n = turned(turn, n);
    return c;
}

Box cube(double half) {
    return Box{{half, half, half}};
}

Hull as_hull(const Box& box) {
    Hull hull;
    const Vec3& e = box.half_extents;
    for (unsigned i = 0; i < 8; ++i)
        hull.points.push_back({(i & 1u) != 0 ? e.x : -e.x, (i & 2u) != 0 ? e.y : -e.y, (i & 4u) != 0 ? e.z : -e.z});
    return hull;
}

// A case of boxes, then with one and with both as hulls.
void add_with_hulls(std::vector<Case>& cases, Case c) {
    cases.push_back(c);
    const Box a = std::get<Box>(c.a), b = std::get<Box>(c.b);
    c.what += ", a hull";
    c.b = as_hull(b);
    cases.push_back(c);
    c.what += " both";
    c.a = as_hull(a);
    cases.push_back(c);
}

void check_answer(const Case& c, const Contact& answer, double precision) {
    const double size = size_of(c), exact = std::min(1e-36, size);
    INFO(c.what << ", precision " << precision << ": distance " << answer.distance << " is " << c.distance << ", error "
                << answer.error << ", normal " << answer.normal.x << ' ' << answer.normal.y << ' ' << answer.normal.z);
    // The case's own numbers are rounded: turns and places by an ulp, of world coordinates too.
    const double rounded = 8e-16 * size + 4e-16 * (length(c.at_a.position) + length(c.at_b.position));
    CHECK(std::fabs(answer.distance - c.distance) <= answer.error + rounded);
    const bool in_float64 = precision > 0.75;
    const double far = in_float64 ? 0 : 0x1p-43 * (length(c.at_a.position) + length(c.at_b.position));
    CHECK(answer.error <= (in_float64 ? c.error : c.error32) * size + far + 4e-37 + exact);
    CHECK(std::fabs(length(answer.normal) - 1) < 1e-6);
    if (c.normals.empty()) return;
    double best = -1;
    for (const Vec3& n : c.normals)
        best = std::max(best, n.x * answer.normal.x + n.y * answer.normal.y + n.z * answer.normal.z);
    // Where the error leaves open whether they touch, it leaves open on which side a thin body is.
    if (std::fabs(c.distance) <= answer.error) best = 1;
    // To a thousandth of a radian: a wrong feature's normal is off by more.
    CHECK(best > 1 - 5e-7);
}

// Each pair `times` times in one call, on the given context; more than some hundred pairs go to a device.
void check_on(Context& context, const std::vector<Case>& cases, std::uint32_t times, double precision) {
    Scene scene;
    std::vector<Pair> pairs;
    for (std::uint32_t i = 0; i < cases.size(); ++i) {
        for (const bool first : {true, false}) {
            Body body;
            body.shape = scene.add_shape(first ? cases[i].a : cases[i].b);
            body.pose = first ? cases[i].at_a : cases[i].at_b;
            body.margin = 10 * size_of(cases[i]) + 1e-35;
            scene.add_body(body);
        }
        for (std::uint32_t k = 0; k < times; ++k) pairs.push_back({2 * i, 2 * i + 1});
    }
    for (const Rejection& rejection : scene.rejected()) FAIL(cases[rejection.body / 2].what << ": " << rejection.why);
    NarrowPhaseOptions options;
    options.precision = precision;
    NarrowPhase narrow(context, options);
    const View<const Contact> contacts = narrow.find(scene, pairs);
    REQUIRE(contacts.size() == pairs.size());  // none is lost
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        REQUIRE(contacts[i].a == pairs[i].a);
        const Contact& first = contacts[i - i % times];
        if (i % times == 0) check_answer(cases[contacts[i].a / 2], first, precision);
        CHECK((contacts[i].distance == first.distance && contacts[i].normal.x == first.normal.x));
    }
}

void check(const std::vector<Case>& cases) {
    Context host = Context::host_only();
    check_on(host, cases, 1, 1.0);
    Context device = test::with_lanes(0, list_devices()[0].lanes);
    for (const double precision : {0.0, 0.5, 1.0}) check_on(device, cases, 200, precision);
}

const std::vector<Quat>& some_turns() {
    static const std::vector<Quat> turns{Quat{}, about({0, 0, 1}, 0.7), about({0.6, 0.3, 0.8}, 1.1)};
    return turns;
}

}  // namespace

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
