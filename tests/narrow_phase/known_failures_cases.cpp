#include "tests/narrow_phase/known_failures_cases.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "clinch/narrow_phase.hpp"
#include "tests/device/devices.hpp"

namespace clinch::test::known {
namespace {

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

// No farther from the body's origin than anything of the body, to rounding.
void check_point(const Shape& shape, const Pose& at, const Vec3& point, double rounded) {
    if (std::holds_alternative<Plane>(shape)) return;
    const Vec3& p = at.position;
    CHECK(length({point.x - p.x, point.y - p.y, point.z - p.z}) <= reach_of(shape) + rounded);
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
    const double points = 1e-5 * size + far + 2 * answer.error + rounded + 4e-37;
    check_point(c.a, c.at_a, answer.on_a, points);
    check_point(c.b, c.at_b, answer.on_b, points);
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

}  // namespace

Quat about(const Vec3& axis, double angle) {
    const double s = std::sin(angle / 2) / length(axis);
    return {std::cos(angle / 2), axis.x * s, axis.y * s, axis.z * s};
}

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

const std::vector<Quat>& some_turns() {
    static const std::vector<Quat> turns{Quat{}, about({0, 0, 1}, 0.7), about({0.6, 0.3, 0.8}, 1.1)};
    return turns;
}

void check(const std::vector<Case>& cases) {
    Context host = Context::host_only();
    check_on(host, cases, 1, 1.0);
    Context device = test::with_lanes(0, list_devices()[0].lanes);
    for (const double precision : {0.0, 0.5, 1.0}) check_on(device, cases, 200, precision);
}

}  // namespace clinch::test::known
