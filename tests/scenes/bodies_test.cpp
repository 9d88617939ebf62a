// The generated scenes of bodies: the same numbers everywhere, and what they promise.
#include "bench/scenes/bodies.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <set>
#include <variant>
#include <vector>

#include "clinch/error.hpp"
#include "clinch/pipeline.hpp"
#include "src/scene/convex_hull.hpp"

using namespace clinch;

namespace {

/// FNV-1a over the bytes of poses and of the points of hulls.
std::uint64_t hash(const Scene& scene) {
    std::uint64_t h = 1469598103934665603u;
    const auto add = [&h](const auto& value) {
        unsigned char bytes[sizeof value];
        std::memcpy(bytes, &value, sizeof value);
        for (const unsigned char b : bytes) h = (h ^ b) * 1099511628211u;
    };
    for (std::uint32_t i = 0; i < scene.row_count(); ++i) {
        const Body body = scene.body({i});
        add(body.pose);
        const Shape& shape = scene.shape(body.shape);
        add(static_cast<std::uint64_t>(shape.index()));
        if (const auto* const hull = std::get_if<Hull>(&shape))
            for (const Vec3& point : hull->points) add(point);
        if (const auto* const capsule = std::get_if<Capsule>(&shape)) add(*capsule);
        if (const auto* const box = std::get_if<Box>(&shape)) add(*box);
    }
    return h;
}

}  // namespace

TEST_CASE("scenes of bodies are the same on every machine", "[host]") {
    CHECK(hash(scenes::make_bodies("mix", 1000, 0)) == 0x96534e9f03ccd716u);
    CHECK(hash(scenes::make_bodies("mix", 1000, 1)) == 0xcc93230245d71061u);
    CHECK(scenes::make_bodies("mix", 0, 0).row_count() == 0);
    CHECK(scenes::make_bodies("mix", 1, 0).row_count() == 1);
    CHECK_THROWS_AS(scenes::make_bodies("max", 1, 0), Error);
}

TEST_CASE("mix has one plane, every class but meshes, and hulls of 8 to 64 corners", "[host]") {
    const Scene scene = scenes::make_bodies("mix", 3000, 7);
    REQUIRE(scene.row_count() == 3000);
    CHECK(scene.rejected().empty());
    std::map<std::size_t, std::size_t> bodies_of;
    std::set<std::size_t> corners;
    for (std::uint32_t i = 0; i < scene.row_count(); ++i) {
        const Shape& shape = scene.shape(scene.body({i}).shape);
        ++bodies_of[shape.index()];
        if (const auto* const hull = std::get_if<Hull>(&shape)) corners.insert(hull->points.size());
    }
    for (std::size_t id = 0; id < scene.shape_count(); ++id)
        if (const auto* const hull = std::get_if<Hull>(&scene.shape({static_cast<std::uint32_t>(id)})))
            CHECK(detail::outermost_points(hull->points).size() == hull->points.size());
    CHECK(bodies_of[5] == 1);
    CHECK(bodies_of.count(7) == 0);
    for (const std::size_t kind : {0u, 1u, 2u, 3u, 4u, 6u}) CHECK(bodies_of[kind] > 400);
    CHECK(corners == std::set<std::size_t>{8, 16, 24, 32, 40, 48, 56, 64});
}

TEST_CASE("a body of mix touches about one other", "[host]") {
    constexpr std::size_t count = 4000;
    const Scene scene = scenes::make_bodies("mix", count, 3);
    Context context = Context::host_only();
    PipelineOptions options;
    options.contacts = true;
    Pipeline pipeline(context, options);
    std::size_t touching = 0, on_plane = 0;
    for (const Contact& contact : pipeline.step(scene).contacts()) (contact.a == 0 ? on_plane : touching) += 1;
    const double others = 2.0 * static_cast<double>(touching) / static_cast<double>(count);
    INFO(others << " others a body, " << on_plane << " bodies on the plane");
    CHECK(others > 0.75);
    CHECK(others < 1.25);
    CHECK(on_plane > 20);
}
