// Manifolds: contacts of several points.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "clinch/error.hpp"
#include "clinch/narrow_phase.hpp"
#include "tests/device/devices.hpp"
#include "tests/narrow_phase/narrow_scenes.hpp"
#include "tests/narrow_phase/surface_oracle.hpp"

using namespace clinch;
using test::found;

namespace {

using Group = std::pair<std::uint32_t, std::uint32_t>;

NarrowPhaseOptions wanting(std::uint32_t points, double precision) {
    NarrowPhaseOptions options;
    options.contacts_per_pair = points;
    options.precision = precision;
    return options;
}

std::map<Group, std::vector<Contact>> grouped(const std::vector<Contact>& contacts) {
    std::map<Group, std::vector<Contact>> out;
    for (const Contact& c : contacts) out[{c.a, c.b}].push_back(c);
    return out;
}

struct Placed {
    Shape shape;
    Pose pose;
};

// The contacts of two bodies, once by the host alone and, the pair many times over, by each device.
std::vector<std::vector<Contact>> everywhere(const Placed& a, const Placed& b, std::uint32_t points, double margin) {
    constexpr std::uint32_t copies = 200;
    Scene scene;
    std::vector<Pair> pairs;
    const ShapeId shape_a = scene.add_shape(a.shape), shape_b = scene.add_shape(b.shape);
    for (std::uint32_t i = 0; i < copies; ++i) {
        Body body;
        body.margin = margin;
        body.shape = shape_a;
        body.pose = a.pose;
        scene.add_body(body);
        body.shape = shape_b;
        body.pose = b.pose;
        scene.add_body(body);
        pairs.push_back({2 * i, 2 * i + 1});
    }
    std::vector<std::vector<Contact>> out;
    Context host = Context::host_only();
    out.push_back(found(host, wanting(points, 0.5), scene, {{0, 1}}));
    for (std::uint32_t i = 0; i < list_devices().size(); ++i)
        for (const double precision : {0.0, 0.5, 1.0}) {
            Context context = test::with_lanes(i, list_devices()[i].lanes);
            const auto groups = grouped(found(context, wanting(points, precision), scene, pairs));
            CHECK(groups.size() == copies);
            for (const auto& [pair, rows] : groups) CHECK(rows.size() == groups.begin()->second.size());
            out.push_back(groups.at({0, 1}));
        }
    return out;
}

double apart(const Vec3& p, const Vec3& q) {
    return std::sqrt((p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y) + (p.z - q.z) * (p.z - q.z));
}

// The points on a, in any order, with the same distance each.
void check_points(const std::vector<Contact>& rows, const std::vector<Vec3>& expected, double distance) {
    REQUIRE(rows.size() == expected.size());
    for (const Vec3& e : expected) {
        INFO("expected " << e.x << ", " << e.y << ", " << e.z);
        CHECK(std::any_of(rows.begin(), rows.end(), [&](const Contact& c) { return apart(c.on_a, e) < 2e-6; }));
    }
    std::set<std::uint32_t> features;
    for (const Contact& c : rows) {
        CHECK(std::abs(c.distance - distance) <= c.error);
        CHECK(c.error < 1e-4);
        features.insert(c.feature);
    }
    CHECK(features.size() == rows.size());
}

const double half_root = std::sqrt(0.5);
const Quat lying{half_root, 0, half_root, 0};                        // z along x
const Quat turned_45{std::cos(M_PI / 8), 0, 0, std::sin(M_PI / 8)};  // about z

Hull cube(double half) {
    Hull hull;
    for (int i = 0; i < 8; ++i)
        hull.points.push_back({(i & 1) != 0 ? half : -half, (i & 2) != 0 ? half : -half, (i & 4) != 0 ? half : -half});
    return hull;
}

}  // namespace

TEST_CASE("boxes and hulls face to face touch in the corners of what both cover", "[device][builds]") {
    const std::vector<Vec3> corners{{0.5, 0.25, 1}, {1, 0.25, 1}, {0.5, 1, 1}, {1, 1, 1}};
    const Pose above{{1.5, 1.25, 1.99}};
    for (const Shape& a : {Shape{Box{{1, 1, 1}}}, Shape{cube(1)}})
        for (const Shape& b : {Shape{Box{{1, 1, 1}}}, Shape{cube(1)}})
            for (const auto& rows : everywhere({a, {}}, {b, above}, 4, 0.0)) check_points(rows, corners, -0.01);
}

TEST_CASE("boxes that lie on one another crosswise touch in eight points", "[device][builds]") {
    const double r = std::sqrt(2.0) - 1.0;
    std::vector<Vec3> corners;
    for (const double x : {-1.0, 1.0})
        for (const double y : {-r, r}) {
            corners.push_back({x, y, 1});
            corners.push_back({y, x, 1});
        }
    for (const auto& rows : everywhere({Box{{1, 1, 1}}, {}}, {Box{{1, 1, 1}}, {{0, 0, 1.75}, turned_45}}, 8, 0.0))
        check_points(rows, corners, -0.25);
}

TEST_CASE("gaps within the margins have manifolds too", "[device][builds]") {
    const std::vector<Vec3> corners{{-0.5, -0.5, 1}, {-0.5, 0.5, 1}, {0.5, -0.5, 1}, {0.5, 0.5, 1}};
    for (const auto& rows : everywhere({Box{{1, 1, 1}}, {}}, {Box{{0.5, 0.5, 0.5}}, {{0, 0, 1.55}}}, 4, 0.03))
        check_points(rows, corners, 0.05);
}

TEST_CASE("what stands or lies on a plane touches it in its face or along its line", "[device][builds]") {
    const Plane ground;
    const double s = 0.5 * half_root;
    struct Case {
        Shape shape;
        Pose pose;
        std::vector<Vec3> points;
    };
    const std::vector<Case> cases{
        {Box{{0.5, 0.25, 1}}, {{0, 0, 0.99}}, {{-0.5, -0.25, 0}, {-0.5, 0.25, 0}, {0.5, -0.25, 0}, {0.5, 0.25, 0}}},
        {cube(0.5), {{3, 0, 0.49}}, {{2.5, -0.5, 0}, {2.5, 0.5, 0}, {3.5, -0.5, 0}, {3.5, 0.5, 0}}},
        {Cylinder{0.5, 1}, {{0, 0, 0.99}}, {{s, s, 0}, {-s, s, 0}, {-s, -s, 0}, {s, -s, 0}}},
        {Cylinder{0.5, 1}, {{0, 0, 0.49}, lying}, {{-1, 0, 0}, {1, 0, 0}}},
        {Cone{0.5, 1}, {{0, 0, 0.99}}, {{s, s, 0}, {-s, s, 0}, {-s, -s, 0}, {s, -s, 0}}},
        {Capsule{0.5, 1}, {{0, 0, 0.49}, lying}, {{-1, 0, 0}, {1, 0, 0}}},
        {Capsule{0.5, 1}, {{0, 0, 1.49}}, {{0, 0, 0}}},
        {Sphere{0.5}, {{0, 0, 0.49}}, {{0, 0, 0}}},
    };
    for (const Case& c : cases) {
        INFO("class " << c.shape.index());
        for (auto rows : everywhere({c.shape, c.pose}, {ground, {}}, 4, 0.0)) {
            for (Contact& row : rows) row.on_a = row.on_b;  // of the plane
            check_points(rows, c.points, -0.01);
        }
    }
}

TEST_CASE("round sides side by side touch along a line", "[device][builds]") {
    const Capsule capsule{0.5, 1};
    const Cylinder cylinder{0.5, 1};
    for (const auto& rows : everywhere({capsule, {}}, {capsule, {{0.99, 0, 0.5}}}, 4, 0.0))
        check_points(rows, {{0.5, 0, -0.5}, {0.5, 0, 1}}, -0.01);
    for (const auto& rows : everywhere({capsule, {}}, {cylinder, {{0.99, 0, 0.5}}}, 4, 0.0))
        check_points(rows, {{0.5, 0, -0.5}, {0.5, 0, 1}}, -0.01);
    for (const auto& rows : everywhere({Box{{1, 1, 1}}, {}}, {capsule, {{0.5, 0, 1.49}, lying}}, 4, 0.0))
        check_points(rows, {{-0.5, 0, 1}, {1, 0, 1}}, -0.01);
    // Crosswise they touch in one point.
    for (const auto& rows : everywhere({capsule, {}}, {capsule, {{0, 0.99, 0}, lying}}, 4, 0.0))
        check_points(rows, {{0, 0.5, 0}}, -0.01);
}

TEST_CASE("features stay the same while bodies rock on one another", "[host]") {
    Context host = Context::host_only();
    test::Random random(91);
    INFO("seed 91");
    for (const Shape& shape : {Shape{Box{{1, 0.5, 0.25}}}, Shape{cube(0.5)}, Shape{Cylinder{0.5, 0.3}}}) {
        std::set<std::vector<std::uint32_t>> seen;
        for (int frame = 0; frame < 50; ++frame) {
            Scene scene;
            Body body;
            body.shape = scene.add_shape(Box{{3, 3, 1}});
            scene.add_body(body);
            body.shape = scene.add_shape(shape);
            const double low = std::holds_alternative<Box>(shape)    ? 0.25
                               : std::holds_alternative<Hull>(shape) ? 0.5
                                                                     : 0.3;
            body.pose.position = {random.between(-1e-3, 1e-3), random.between(-1e-3, 1e-3), 1.0 + low - 0.01};
            body.pose.rotation = {1.0, random.between(-1e-4, 1e-4), random.between(-1e-4, 1e-4),
                                  random.between(-1e-3, 1e-3)};
            scene.add_body(body);
            std::vector<std::uint32_t> features;
            for (const Contact& c : found(host, wanting(4, 0.5), scene, {{0, 1}})) features.push_back(c.feature);
            CHECK(features.size() == 4);
            seen.insert(features);
        }
        INFO("class " << shape.index());
        CHECK(seen.size() == 1);
    }
}

namespace {

// What must hold of a pair's points, given the pair's one contact.
void check_manifold(const Scene& scene, const Contact& whole, const std::vector<Contact>& rows, std::uint32_t wanted) {
    INFO("pair " << whole.a << ", " << whole.b << ", classes " << scene.shape({scene.columns().shape[whole.a]}).index()
                 << ", " << scene.shape({scene.columns().shape[whole.b]}).index() << ", distance " << whole.distance);
    CHECK(rows.size() <= wanted);
    const auto deepest = std::min_element(rows.begin(), rows.end(),
                                          [](const Contact& p, const Contact& q) { return p.distance < q.distance; });
    CHECK(std::any_of(rows.begin(), rows.end(),
                      [&](const Contact& c) { return c.distance == whole.distance && c.error == whole.error; }));
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Contact& c = rows[i];
        if (i > 0) CHECK(rows[i - 1].feature < c.feature);
        CHECK(c.distance <= c.error);
        CHECK(apart(c.normal, whole.normal) == 0.0);
        const Vec3 b{c.on_a.x + c.distance * c.normal.x, c.on_a.y + c.distance * c.normal.y,
                     c.on_a.z + c.distance * c.normal.z};
        CHECK(apart(b, c.on_b) == 0.0);
        const double off_a =
            test::surface_distance(scene.shape({scene.columns().shape[c.a]}), scene.body({c.a}).pose, c.on_a);
        const double off_b =
            test::surface_distance(scene.shape({scene.columns().shape[c.b]}), scene.body({c.b}).pose, c.on_b);
        INFO("feature " << std::hex << c.feature << std::dec << ", distance " << c.distance << ", error " << c.error);
        // Points may be off along the surface as far as off it; the witness of round bodies, where the distance has its
        // minimum, by the root of how far that is off.
        const double off = std::max(4.0 * c.error + 4e-6, &c == &*deepest ? std::sqrt(c.error) : 0.0);
        CHECK(std::abs(off_a) <= off);
        CHECK(std::abs(off_b) <= off);
    }
}

// Each call in a context of its own: the simulator takes memory that is used again for memory that was never written.
void check_scene(const std::function<Context()>& make, double precision, const Scene& scene,
                 const std::vector<Pair>& pairs, const std::vector<std::uint32_t>& numbers) {
    Context one = make();
    const auto whole = test::by_pair(found(one, wanting(1, precision), scene, pairs));
    for (const std::uint32_t wanted : numbers) {
        Context context = make();
        const auto groups = grouped(found(context, wanting(wanted, precision), scene, pairs));
        CHECK(groups.size() == whole.size());
        for (const auto& [pair, rows] : groups) check_manifold(scene, whole.at(pair), rows, wanted);
    }
}

}  // namespace

TEST_CASE("points of any manifold lie on both surfaces", "[device][builds]") {
    for (const std::uint64_t seed : {92u, 93u}) {
        test::Random random(seed);
        INFO("seed " << seed);
        const Scene scene = test::random_bodies(60, 2.0, {0, 0, 0}, random);
        const std::vector<Pair> pairs = test::all_pairs(scene);
        const std::vector<std::uint32_t> numbers{2, 3, 4, 8};
        check_scene(Context::host_only, 1.0, scene, pairs, numbers);
        for (std::uint32_t i = 0; i < list_devices().size(); ++i)
            for (const double precision : {0.0, 0.5, 1.0})
                check_scene([&] { return test::with_lanes(i, list_devices()[i].lanes); }, precision, scene, pairs,
                            numbers);
    }
}

TEST_CASE("manifolds are the same bytes on every device", "[device][builds]") {
    test::Random random(94);
    INFO("seed 94");
    const Scene scene = test::random_bodies(50, 2.0, {0, 0, 0}, random);
    const std::vector<Pair> pairs = test::all_pairs(scene);
    std::vector<Contact> first;
    for (std::uint32_t i = 0; i < list_devices().size(); ++i)
        for (const std::uint32_t lanes : std::set<std::uint32_t>{1u, list_devices()[i].lanes}) {
            Context context = test::with_lanes(i, lanes);
            INFO("device " << i << ", lanes " << lanes);
            const std::vector<Contact> contacts = found(context, wanting(4, 0.0), scene, pairs);
            REQUIRE(contacts.size() > 400);
            if (first.empty()) first = contacts;
            REQUIRE(contacts.size() == first.size());
            CHECK(std::memcmp(contacts.data(), first.data(), first.size() * sizeof first[0]) == 0);
        }
}

TEST_CASE("a few manifolds", "[device][plain]") {
    test::Random random(95);
    INFO("seed 95");
    const Scene scene = test::random_bodies(18, 1.2, {0, 0, 0}, random);
    const std::vector<Pair> pairs = test::all_pairs(scene);
    REQUIRE(pairs.size() >= 128);  // on a device
    for (std::uint32_t i = 0; i < list_devices().size(); ++i)
        check_scene([&] { return test::with_lanes(i, 8); }, 0.0, scene, pairs, {4});
}

TEST_CASE("how many contacts a pair may have is checked", "[host]") {
    Context host = Context::host_only();
    for (const std::uint32_t points : {0u, 9u})
        CHECK_THROWS_WITH(NarrowPhase(host, wanting(points, 0.5)),
                          Catch::Contains("contacts_per_pair") && Catch::Contains("from 1 to 8"));
}
