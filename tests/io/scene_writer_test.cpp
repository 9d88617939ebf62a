// Scenes into .json files and back.
#include "tools/io/scene_writer.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "clinch/error.hpp"
#include "tests/io/temp_folder.hpp"
#include "tools/io/scene_file.hpp"

using namespace clinch;
using Catch::Contains;

namespace {

void write(const std::string& path, const Scene& scene) {
    io::OutputFile file(path);
    io::write_scene(file, scene);
    file.commit();
}

template <class T>
bool same_bits(const T& a, const T& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

/// A body of each class, the last with a value of its own in every field.
Scene every_class() {
    Scene scene;
    for (const Shape& shape :
         {Shape(Sphere{0.1}), Shape(Box{{0.1, 1e-30, 1e22}}), Shape(Capsule{0.3, 0.0}), Shape(Cylinder{1.0 / 3.0, 2.0}),
          Shape(Cone{5e-324, 1.7976931348623157e308}), Shape(Plane{{0.6, -0.0, 0.8}, -2.5}),
          Shape(Hull{{{0, 0, 0}, {1, 0, 0}, {0, 0.1, 0}, {0, 0, 123456789012345680.0}}})})
        scene.add_body({scene.add_shape(shape)});
    Body body;
    body.shape = scene.add_shape(Sphere{0.5});
    body.pose = {{-0.0, 0.0, 0.0}, {0.5, -0.5, 0.5, -0.5}};
    body.velocity = {1, 2, 3};
    body.angular_velocity = {-0.1, 0, 0};
    body.motion = Motion::Sleeping;
    body.group = 4294967295u;
    body.mask = 6;
    body.margin = 0.25;
    scene.add_body(body);
    return scene;
}

}  // namespace

TEST_CASE("a scene that is written and read is the same to the bit", "[host]") {
    const test::TempFolder folder;
    const Scene scene = every_class();
    write(folder / "s.json", scene);
    const io::LoadedScene loaded = io::read_scene(folder / "s.json");
    REQUIRE(loaded.scene.row_count() == scene.row_count());
    for (std::uint32_t i = 0; i < scene.row_count(); ++i) {
        INFO("body " << i);
        const Body was = scene.body({i}), is = loaded.scene.body({i});
        CHECK(same_bits(was.pose, is.pose));
        CHECK(same_bits(was.velocity, is.velocity));
        CHECK(same_bits(was.angular_velocity, is.angular_velocity));
        CHECK(was.motion == is.motion);
        CHECK(was.group == is.group);
        CHECK(was.mask == is.mask);
        CHECK(same_bits(was.margin, is.margin));
        const Shape &before = scene.shape(was.shape), &after = loaded.scene.shape(is.shape);
        REQUIRE(before.index() == after.index());
        if (const auto* const hull = std::get_if<Hull>(&before)) {
            const auto& points = std::get<Hull>(after).points;
            REQUIRE(points.size() == hull->points.size());
            for (std::size_t p = 0; p < points.size(); ++p) CHECK(same_bits(points[p], hull->points[p]));
        }
        if (const auto* const box = std::get_if<Box>(&before)) CHECK(same_bits(*box, std::get<Box>(after)));
        if (const auto* const ball = std::get_if<Sphere>(&before)) CHECK(same_bits(*ball, std::get<Sphere>(after)));
        if (const auto* const capsule = std::get_if<Capsule>(&before))
            CHECK(same_bits(*capsule, std::get<Capsule>(after)));
        if (const auto* const cylinder = std::get_if<Cylinder>(&before))
            CHECK(same_bits(*cylinder, std::get<Cylinder>(after)));
        if (const auto* const cone = std::get_if<Cone>(&before)) CHECK(same_bits(*cone, std::get<Cone>(after)));
        if (const auto* const plane = std::get_if<Plane>(&before)) CHECK(same_bits(*plane, std::get<Plane>(after)));
    }
    write(folder / "e.json", Scene());
    CHECK(io::read_scene(folder / "e.json").scene.row_count() == 0);
}

TEST_CASE("what a scene file cannot hold is refused", "[host]") {
    const test::TempFolder folder;
    Scene mesh;
    mesh.add_body({mesh.add_shape(Sphere{1.0})});
    mesh.add_body({mesh.add_shape(Mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}})});
    CHECK_THROWS_AS(write(folder / "s.json", mesh), Error);
    CHECK_THROWS_WITH(write(folder / "s.json", mesh), Contains("body 1 cannot be written") && Contains("mesh"));
    Scene nan;
    nan.add_body({nan.add_shape(Sphere{std::numeric_limits<double>::quiet_NaN()})});
    CHECK_THROWS_WITH(write(folder / "s.json", nan), Contains("body 0 cannot be written") && Contains("not finite"));
    Scene removed = every_class();
    removed.remove_body({2});
    CHECK_THROWS_WITH(write(folder / "s.json", removed), Contains("body 2 cannot be written") && Contains("removed"));
    CHECK(folder.names().empty());
}
