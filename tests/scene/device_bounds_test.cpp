// The bounds kernel gives the bytes of its host twin, whatever changes.
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "src/scene/bounds.hpp"
#include "src/scene/same_bits.hpp"
#include "tests/device/devices.hpp"
#include "tests/random.hpp"
#include "tests/scene/bounds_oracle.hpp"

using namespace clinch;

namespace {

// Brings both up to date; the rows sent. Fails on the first box that differs in any bit.
std::size_t step(detail::Device& device, detail::DeviceBounds& bounds, const Scene& scene) {
    const std::size_t sent = bounds.upload(scene);
    bounds.compute();
    std::vector<Aabb> boxes(scene.row_count());
    if (!boxes.empty()) device.read(bounds.boxes(), boxes.data(), boxes.size() * sizeof(Aabb));
    detail::HostBounds host;
    host.update(scene);
    std::size_t different = 0;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (detail::same_bits(boxes[i], host.boxes()[i])) continue;
        if (different++ > 0) continue;
        INFO("row " << i << " class " << scene.shape({scene.columns().shape[i]}).index());
        for (std::size_t k = 0; k < 3; ++k) {
            CHECK(boxes[i].min[k] == host.boxes()[i].min[k]);
            CHECK(boxes[i].max[k] == host.boxes()[i].max[k]);
        }
    }
    CHECK(different == 0);
    return sent;
}

Hull random_hull(test::Random& random, std::size_t count) {
    Hull hull;
    for (std::size_t i = 0; i < count; ++i)
        hull.points.push_back({random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)});
    return hull;
}

// Moves, removals, rejections, growth, other scenes. No shape is replaced here: the oclgrind simulator loses what it
// knew about a buffer when the host writes into the middle of it.
void run_changes(detail::Device& device, std::size_t count, std::uint64_t seed) {
    INFO("seed " << seed);
    test::Random random(seed);
    Scene scene = test::hostile_scene(count, seed);
    const std::uint32_t plane = scene.add_shape(Plane{}).index;
    const ShapeId cone = scene.add_shape(Cone{1, 2}), hull = scene.add_shape(random_hull(random, 50));
    detail::DeviceBounds bounds(device);
    CHECK(step(device, bounds, scene) == count);
    CHECK(step(device, bounds, scene) == 0);

    // A few rows move, one leaves, one is rejected, one becomes a plane.
    scene.set_pose({1}, {{4, 5, 6}, test::random_rotation(random)});
    scene.remove_body({2});
    scene.set_pose({3}, {{NAN, 0, 0}, {}});
    scene.set_shapes(&plane, 1, 4);
    CHECK(step(device, bounds, scene) == 4);
    CHECK(scene.rejected().size() == 1);

    // They come back; the removed row is used again.
    scene.set_pose({3}, {{0, 0, 0}, {}});
    scene.set_body({4}, test::hostile_body(cone, random));
    CHECK(scene.add_body(test::hostile_body(hull, random)).index == 2);
    CHECK(step(device, bounds, scene) == 3);

    // The scene outgrows the buffer: all rows are sent.
    scene.add_bodies(count, test::hostile_body(hull, random));
    CHECK(step(device, bounds, scene) == 2 * count);
    CHECK(step(device, bounds, scene) == 0);

    // Another scene, a copy, and back again.
    const Scene other = test::hostile_scene(5, seed + 1);
    CHECK(step(device, bounds, other) == 5);
    const Scene copy = scene;
    CHECK(step(device, bounds, copy) == 2 * count);
    CHECK(step(device, bounds, scene) == 2 * count);
    const Scene moved = std::move(scene);
    CHECK(step(device, bounds, moved) == 0);
}

template <class F>
void on_each_device(const F& run) {
    const Context context = test::all_devices();
    REQUIRE_FALSE(context.devices().empty());
    for (std::size_t i = 0; i < context.devices().size(); ++i) {
        INFO(context.devices()[i].name);
        run(context.impl().open(i));
    }
}

}  // namespace

TEST_CASE("device bounds follow a small scene, byte for byte as on the host", "[device][small]") {
    on_each_device([](detail::Device& device) { run_changes(device, 70, 21); });
}

TEST_CASE("device bounds follow a large hostile scene, byte for byte as on the host", "[device]") {
    on_each_device([](detail::Device& device) { run_changes(device, 21000, 22); });
}

TEST_CASE("device bounds of an empty scene, and of one without shapes that have vertices", "[device][small]") {
    on_each_device([](detail::Device& device) {
        Scene scene;
        detail::DeviceBounds bounds(device);
        CHECK(step(device, bounds, scene) == 0);
        scene.add_body({scene.add_shape(Sphere{}), {}, {}, {}});
        CHECK(step(device, bounds, scene) == 1);
    });
}

TEST_CASE("rows uploaded and never computed are sent again", "[device]") {
    on_each_device([](detail::Device& device) {
        Scene scene = test::hostile_scene(100, 23);
        detail::DeviceBounds bounds(device);
        CHECK(bounds.upload(scene) == 100);
        scene.set_pose({5}, {});
        CHECK(step(device, bounds, scene) == 100);
    });
}

TEST_CASE("replaced and added shapes are sent, and only their bodies with them", "[device]") {
    on_each_device([](detail::Device& device) {
        test::Random random(26);
        Scene scene = test::hostile_scene(70, 27);
        detail::DeviceBounds bounds(device);
        step(device, bounds, scene);
        const ShapeId hull{scene.columns().shape[5]};
        scene.set_shape(hull, random_hull(random, 90));
        CHECK(step(device, bounds, scene) == 1);
        scene.set_shape(hull, random_hull(random, 5));
        // A shape that no body has yet is sent with the first rows that change, here or later.
        const ShapeId unused = scene.add_shape(random_hull(random, 20));
        CHECK(step(device, bounds, scene) == 1);
        const ShapeId later = scene.add_shape(random_hull(random, 2000));
        CHECK(step(device, bounds, scene) == 0);
        scene.set_shapes(&unused.index, 1, 0);
        scene.set_shapes(&later.index, 1, 1);
        CHECK(step(device, bounds, scene) == 2);
    });
}

TEST_CASE("device bounds keep packed vertices right over many deformations", "[device]") {
    on_each_device([](detail::Device& device) {
        test::Random random(24);
        Scene scene = test::hostile_scene(70, 25);
        detail::DeviceBounds bounds(device);
        for (int frame = 0; frame < 40; ++frame) {
            for (int k = 0; k < 5; ++k) {
                const auto row = static_cast<std::size_t>(random.below(10) * 7 + 5);  // hulls
                scene.set_shape({scene.columns().shape[row]}, random_hull(random, 4 + random.below(300)));
            }
            CHECK(step(device, bounds, scene) <= (frame == 0 ? 70 : 5));
        }
    });
}
