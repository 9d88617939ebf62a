// Every reason for which a body is left out, in words, and how the list follows the scene.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <thread>
#include <vector>

#include "clinch/scene.hpp"
#include "src/scene/scene_impl.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

constexpr double quiet_nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

Mesh tetrahedron() {
    return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}}};
}

std::string why_body(const Shape& shape, const std::function<void(Body&)>& spoil) {
    Scene scene;
    Body body;
    body.shape = scene.add_shape(shape);
    scene.add_body(body);
    spoil(body);
    scene.add_body(body);
    scene.add_body({body.shape, {}, {}, {}});
    const auto& rejected = scene.rejected();
    if (rejected.empty()) return {};
    CHECK(rejected.size() == 1);
    CHECK(rejected.front().body == 1);
    CHECK_FALSE(scene.impl().row_usable(1));
    return rejected.front().why;
}

Plane plane(const Vec3& normal, double offset = 0.0) {
    return {normal, offset};
}

}  // namespace

TEST_CASE("shapes say why they are invalid", "[host]") {
    CHECK(why_invalid(Sphere{-1}) == "radius is -1 and must be finite and > 0");
    CHECK(why_invalid(Sphere{0}) == "radius is 0 and must be finite and > 0");
    CHECK(why_invalid(Sphere{quiet_nan}) == "radius is NaN and must be finite and > 0");
    CHECK(why_invalid(Sphere{infinity}) == "radius is inf and must be finite and > 0");
    CHECK(why_invalid(Box{{0, 1, 1}}) == "half extent x is 0 and must be finite and > 0");
    CHECK(why_invalid(Box{{1, -2, 1}}) == "half extent y is -2 and must be finite and > 0");
    CHECK(why_invalid(Box{{1, 1, quiet_nan}}) == "half extent z is NaN and must be finite and > 0");
    CHECK(why_invalid(Capsule{0, 1}) == "radius is 0 and must be finite and > 0");
    CHECK(why_invalid(Capsule{1, -1e-9}) == "half height is -1e-09 and must be finite and >= 0");
    CHECK(why_invalid(Capsule{1, quiet_nan}) == "half height is NaN and must be finite and >= 0");
    CHECK(why_invalid(Cylinder{1, 0}) == "half height is 0 and must be finite and > 0");
    CHECK(why_invalid(Cylinder{-1, 1}) == "radius is -1 and must be finite and > 0");
    CHECK(why_invalid(Cone{1, 0}) == "half height is 0 and must be finite and > 0");
    CHECK(why_invalid(Cone{quiet_nan, 1}) == "radius is NaN and must be finite and > 0");
    CHECK(why_invalid(plane({0, 0, 1.002})) == "plane normal has length 1.002 and must be within 1e-3 of 1");
    CHECK(why_invalid(plane({0, 0, 0})) == "plane normal has length 0 and must be within 1e-3 of 1");
    CHECK(why_invalid(plane({quiet_nan, 0, 1})) == "plane normal has length NaN and must be within 1e-3 of 1");
    CHECK(why_invalid(plane({0, 0, 1}, -infinity)) == "plane offset is -inf and must be finite");
    CHECK(why_invalid(Hull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}) == "hull has 3 points and must have at least 4");
    CHECK(why_invalid(Hull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}}) ==
          "hull has no volume: its points lie in one plane");
    CHECK(why_invalid(Hull{{{0, 0, 0}, {1, quiet_nan, 0}, {0, 1, 0}, {1, 1, 0}}}) ==
          "hull point 1 has a coordinate that is NaN and must be finite");
    Mesh mesh;
    CHECK(why_invalid(mesh) == "mesh has no triangles and must have at least 1");
    mesh = tetrahedron();
    mesh.triangles[3][1] = 4;
    CHECK(why_invalid(mesh) == "mesh triangle 3 names vertex 4 and must name one below 4");
    mesh = tetrahedron();
    mesh.vertices[2].z = infinity;
    CHECK(why_invalid(mesh) == "mesh vertex 2 has a coordinate that is inf and must be finite");
}

TEST_CASE("shapes at the edge of what is valid are valid", "[host]") {
    CHECK(why_invalid(Sphere{5e-324}).empty());
    CHECK(why_invalid(Capsule{1, 0}).empty());
    CHECK(why_invalid(plane({0, 0, 1.0009}, 1e300)).empty());
    CHECK(why_invalid(plane({0, 0.6, -0.8})).empty());
    CHECK(why_invalid(Hull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1e-9}}}).empty());
    CHECK(why_invalid(tetrahedron()).empty());
    Mesh flat{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
    CHECK(why_invalid(flat).empty());
}

TEST_CASE("bodies are rejected with what was found and what is accepted", "[host]") {
    const Shape ball = Sphere{0.5};
    const auto why = [&](const std::function<void(Body&)>& spoil) { return why_body(ball, spoil); };
    CHECK(why([](Body& b) { b.pose.position.y = quiet_nan; }) == "position y is NaN and must be finite");
    CHECK(why([](Body& b) { b.pose.position.z = -infinity; }) == "position z is -inf and must be finite");
    CHECK(why([](Body& b) { b.pose.rotation.w = 2; }) == "rotation has length 2 and must be within 1e-3 of 1");
    CHECK(why([](Body& b) { b.pose.rotation.w = 0; }) == "rotation has length 0 and must be within 1e-3 of 1");
    CHECK(why([](Body& b) { b.pose.rotation.x = quiet_nan; }) ==
          "rotation has length NaN and must be within 1e-3 of 1");
    CHECK(why([](Body& b) { b.pose.rotation.w = 1.0011; }) ==
          "rotation has length 1.0011 and must be within 1e-3 of 1");
    CHECK(why([](Body& b) { b.velocity.x = infinity; }) == "velocity x is inf and must be finite");
    CHECK(why([](Body& b) { b.angular_velocity.z = quiet_nan; }) == "angular velocity z is NaN and must be finite");
    CHECK(why([](Body& b) { b.margin = -0.25; }) == "margin is -0.25 and must be finite and >= 0");
    CHECK(why([](Body& b) { b.margin = quiet_nan; }) == "margin is NaN and must be finite and >= 0");
    CHECK(why([](Body& b) { b.motion = static_cast<Motion>(4); }) ==
          "motion is 4 and must be 0 (static), 1 (kinematic), 2 (dynamic) or 3 (sleeping)");
    CHECK(why([](Body& b) { b.pose.position.x = -2e38; }) ==
          "position, size and margin together reach 2e+38 and must stay within 1e38");
    CHECK(why([](Body& b) { b.margin = 1e300; }) ==
          "position, size and margin together reach 1e+300 and must stay within 1e38");
    CHECK(why([](Body& b) { b.pose.rotation = {0.9991, 0, 0, 0}; }).empty());
    CHECK(why([](Body& b) { b.pose.position = {1e37, -1e37, 1e37}; }).empty());
}

TEST_CASE("planes are not rejected for their size, and bodies of large or bad shapes are", "[host]") {
    CHECK(why_body(plane({0, 0, 1}, 1e300), [](Body& b) { b.pose.position.x = 1e30; }).empty());
    CHECK(why_body(Plane{}, [](Body& b) { b.pose.position.x = quiet_nan; }) == "position x is NaN and must be finite");
    Scene scene;
    const auto add = [&](const Shape& shape) { return scene.add_body({scene.add_shape(shape), {}, {}, {}}).index; };
    const Shape shapes[] = {Sphere{1e39},
                            Box{{5e37, 4e37, 3e37}},
                            Hull{{{0, 0, 0}, {1e60, 0, 0}, {0, 1e60, 0}, {0, 0, 1e60}}},
                            Hull{{{0, 0, 0}, {1e308, 0, 0}, {0, -1e308, 0}, {0, 0, 1e308}}},
                            plane({0, 0, 2}),
                            Mesh{}};
    for (const Shape& shape : shapes) {
        const std::uint32_t row = add(shape);
        INFO("shape " << row);
        REQUIRE(scene.rejected().size() == row + 1);
        CHECK_FALSE(scene.rejected()[row].why.empty());
    }
    CHECK(scene.rejected()[1].why == "position, size and margin together reach 1.2e+38 and must stay within 1e38");
    CHECK(scene.rejected()[4].why == "plane normal has length 2 and must be within 1e-3 of 1");
    scene.set_shape({5}, Sphere{});
    CHECK(scene.rejected().size() == 5);
    CHECK(scene.impl().plane_rows().empty());
    scene.set_shape({4}, Plane{});
    CHECK(scene.impl().plane_rows() == std::vector<std::uint32_t>{4});
}

TEST_CASE("the list of rejections equals one made from scratch, whatever happened before", "[host]") {
    test::Random random(41);
    Scene scene;
    const std::uint32_t good = scene.add_shape(Sphere{1}).index, bad = scene.add_shape(Sphere{-1}).index;
    Body body;
    body.shape = {good};
    scene.add_bodies(50, body);
    for (int n = 0; n < 4000; ++n) {
        const auto row = static_cast<std::uint32_t>(random.below(50));
        if (!scene.contains({row})) {
            scene.add_body(body);
            continue;
        }
        const double wild = random.below(2) == 0 ? quiet_nan : static_cast<double>(random.below(5));
        const double v[4] = {1.0, 0.0, 0.0, random.below(2) == 0 ? wild : 0.0};
        switch (random.below(7)) {
            case 0:
                scene.set_positions(v + 1, 1, row);
                break;
            case 1:
                scene.set_rotations(v, 1, row);
                break;
            case 2:
                scene.set_velocities(v + 1, 1, row);
                break;
            case 3:
                scene.set_margins(v + 3, 1, row);
                break;
            case 4:
                scene.set_shapes(random.below(2) == 0 ? &good : &bad, 1, row);
                break;
            case 5:
                scene.set_motion({row}, static_cast<Motion>(random.below(6)));
                break;
            default:
                scene.remove_body({row});
        }
        if (random.below(8) != 0) continue;
        Scene fresh;
        fresh.add_shape(Sphere{1});
        fresh.add_shape(Sphere{-1});
        for (std::uint32_t r = 0; r < 50; ++r) fresh.add_body(scene.contains({r}) ? scene.body({r}) : body);
        const auto &a = scene.rejected(), &b = fresh.rejected();
        REQUIRE(a.size() == b.size());
        for (std::size_t i = 0; i < a.size(); ++i) {
            REQUIRE(a[i].body == b[i].body);
            REQUIRE(a[i].why == b[i].why);
            REQUIRE_FALSE(scene.impl().row_usable(a[i].body));
        }
    }
}

TEST_CASE("a rejection that comes or goes changes the row", "[host]") {
    Scene scene;
    scene.add_body({scene.add_shape(Sphere{1}), {}, {}, {}});
    const double bad[3] = {quiet_nan, 0, 0}, good[3] = {};
    const std::uint64_t version = scene.version();
    scene.set_velocities(bad, 1);
    CHECK(scene.row_version(0) > version);
    CHECK(scene.rejected().size() == 1);
    const std::uint64_t after = scene.version();
    scene.set_velocities(good, 1);
    CHECK(scene.row_version(0) > after);
    CHECK(scene.rejected().empty());
}

TEST_CASE("many threads may read one scene", "[host]") {
    Scene scene;
    Body body;
    body.shape = scene.add_shape(Sphere{1});
    body.margin = -1;
    scene.add_bodies(2000, body);
    std::vector<std::size_t> sizes(4);
    std::vector<std::thread> threads;
    threads.reserve(sizes.size());
    for (std::size_t& size : sizes) threads.emplace_back([&scene, &size] { size = scene.rejected().size(); });
    for (std::thread& thread : threads) thread.join();
    CHECK(sizes == std::vector<std::size_t>(4, 2000));
}
