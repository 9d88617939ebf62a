// Scenes of bodies that fall, from the cloud to the pile.
#include "bench/scenes/falling.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "bench/scenes/bodies.hpp"
#include "bench/scenes/falling_shapes.hpp"
#include "clinch/error.hpp"
#include "clinch/pipeline.hpp"
#include "src/scene/convex_hull.hpp"

using namespace clinch;

namespace {

constexpr std::size_t few = 300;

/// FNV-1a over the bytes of all poses and velocities.
std::uint64_t hash(const Scene& scene) {
    std::uint64_t h = 1469598103934665603u;
    const auto add = [&h](const auto& column) {
        std::vector<unsigned char> bytes(column.size() * sizeof column[0]);
        if (!bytes.empty()) std::memcpy(bytes.data(), column.data(), bytes.size());
        for (const unsigned char b : bytes) h = (h ^ b) * 1099511628211u;
    };
    const SceneColumns columns = scene.columns();
    add(columns.position);
    add(columns.rotation);
    add(columns.velocity);
    add(columns.angular_velocity);
    return h;
}

std::uint64_t hash_after(const std::string& kind, std::size_t count, std::uint64_t seed, std::size_t frames) {
    scenes::FallingBodies falling(kind, count, seed);
    for (std::size_t i = 0; i < frames; ++i) falling.step();
    return hash(falling.scene());
}

bool is_static(const Scene& scene, std::size_t row) {
    return scene.columns().motion[row] == Motion::Static;
}

/// A rotated point, by another formula than the generator's own.
Vec3 rotated(const Quat& q, const Vec3& p) {
    const Vec3 t{2.0 * (q.y * p.z - q.z * p.y), 2.0 * (q.z * p.x - q.x * p.z), 2.0 * (q.x * p.y - q.y * p.x)};
    return {p.x + q.w * t.x + q.y * t.z - q.z * t.y, p.y + q.w * t.y + q.z * t.x - q.x * t.z,
            p.z + q.w * t.z + q.x * t.y - q.y * t.x};
}

/// The points of a falling body's shape whose hull, grown by `round`, it is; world space.
std::vector<Vec3> world_corners(const Scene& scene, std::uint32_t row, double& round) {
    const Body body = scene.body({row});
    const Shape& shape = scene.shape(body.shape);
    std::vector<Vec3> corners;
    round = 0.0;
    if (const auto* const sphere = std::get_if<Sphere>(&shape)) {
        corners.emplace_back();
        round = sphere->radius;
    } else if (const auto* const box = std::get_if<Box>(&shape)) {
        const Vec3& h = box->half_extents;
        for (const double x : {-h.x, h.x})
            for (const double y : {-h.y, h.y})
                for (const double z : {-h.z, h.z}) corners.push_back({x, y, z});
    } else {
        corners = std::get<Hull>(shape).points;
    }
    for (Vec3& corner : corners) {
        const Vec3 r = rotated(body.pose.rotation, corner);
        const Vec3& p = body.pose.position;
        corner = {p.x + r.x, p.y + r.y, p.z + r.z};
    }
    return corners;
}

struct HalfSpace {
    Vec3 normal;  // points to where bodies may be
    double offset;
};

/// What bodies must stay above: the plane, or the inner face of each piece of the bowl.
std::vector<HalfSpace> ground(const Scene& scene) {
    std::vector<HalfSpace> all;
    for (std::uint32_t row = 0; row < scene.row_count() && is_static(scene, row); ++row) {
        const Body body = scene.body({row});
        const Shape& shape = scene.shape(body.shape);
        if (std::holds_alternative<Cone>(shape)) continue;
        const Vec3 n = rotated(body.pose.rotation, {0.0, 0.0, 1.0});
        const Vec3& p = body.pose.position;
        const auto* const box = std::get_if<Box>(&shape);
        all.push_back({n, n.x * p.x + n.y * p.y + n.z * p.z + (box != nullptr ? box->half_extents.z : 0.0)});
    }
    return all;
}

/// How deep the falling bodies reach below the ground, at most.
double deepest_below(const Scene& scene, const std::vector<HalfSpace>& ground) {
    double deepest = -std::numeric_limits<double>::infinity();
    for (std::uint32_t row = 0; row < scene.row_count(); ++row) {
        if (is_static(scene, row)) continue;
        double round = 0.0;
        for (const Vec3& c : world_corners(scene, row, round))
            for (const HalfSpace& half : ground)
                deepest = std::max(
                    deepest, half.offset + round - (half.normal.x * c.x + half.normal.y * c.y + half.normal.z * c.z));
    }
    return deepest;
}

struct Touches {
    std::size_t pairs, touching;
    double deepest;
};

Touches touches(const Scene& scene) {
    Context context = Context::host_only();
    PipelineOptions options;
    options.broad_phase.algorithm = "host-sweep";
    options.contacts = true;
    options.narrow_phase.contacts_per_pair = 1;
    Pipeline pipeline(context, options);
    const StepResult& result = pipeline.step(scene);
    Touches found{result.pairs().size(), 0, 0.0};
    for (const Contact& contact : result.contacts()) {
        if (contact.distance > 0.0) continue;
        ++found.touching;
        found.deepest = std::max(found.deepest, -contact.distance);
    }
    return found;
}

void run_to_rest(scenes::FallingBodies& falling) {
    while (falling.moving() > 0 && falling.frame() < 200) falling.step();
}

}  // namespace

TEST_CASE("frames of falling bodies are the same bytes on every machine, and differ by the seed", "[host]") {
    const std::map<std::string, std::array<std::uint64_t, 2>> expected{
        {"cubes-on-plane", {0xbd759a9b7f2d44c1u, 0x4da55a7192b22a47u}},
        {"balls-in-bowl", {0x7eef911ed740c7f5u, 0x61969d87a438726eu}},
        {"tori-hulls", {0x6eea77c08f1e734eu, 0x78d6650d48035dfbu}},
        {"alphabet-hulls", {0xe2cef289cca66485u, 0xed673f7c56986fd3u}},
    };
    REQUIRE(scenes::falling_kinds().size() == expected.size());
    for (const auto& [kind, hashes] : expected) {
        INFO(kind);
        CHECK(hash_after(kind, few, 1, 0) == hashes[0]);
        CHECK(hash_after(kind, few, 1, 80) == hashes[1]);
        CHECK(hash_after(kind, few, 2, 0) != hashes[0]);
        CHECK(hash_after(kind, few, 2, 80) != hashes[1]);
    }
}

TEST_CASE("falling bodies are valid in all frames, stay on the ground's side and come to rest", "[host]") {
    for (const scenes::FallingKind& kind : scenes::falling_kinds()) {
        INFO(kind.kind.name);
        scenes::FallingBodies falling(kind.kind.name, few, 5);
        const Scene& scene = falling.scene();
        const Scene first = scene;
        REQUIRE(scene.row_count() == few);
        const std::vector<HalfSpace> below = ground(scene);
        REQUIRE_FALSE(below.empty());
        const auto statics = static_cast<std::size_t>(
            std::count(scene.columns().motion.begin(), scene.columns().motion.end(), Motion::Static));
        REQUIRE(falling.moving() == few - statics);
        // Bodies lie sunk by 0.02; the bowl's pieces are flat where the ball they stand for is round.
        const double allowed = below.size() > 1 ? 0.12 : 0.02 + 1e-9;
        for (std::size_t frame = 1; falling.moving() > 0 && frame <= 200; ++frame) {
            const std::size_t moving = falling.moving();
            falling.step();
            INFO("frame " << frame);
            REQUIRE(falling.frame() == frame);
            REQUIRE(falling.moving() <= moving);
            REQUIRE(scene.rejected().empty());
            REQUIRE(deepest_below(scene, below) <= allowed);
        }
        REQUIRE(falling.moving() == 0);
        CHECK(falling.frame() >= 100);
        const std::uint64_t version = scene.version();
        for (int i = 0; i < 10; ++i) falling.step();
        CHECK(scene.version() == version);
        const SceneColumns was = first.columns(), is = scene.columns();
        for (std::size_t row = 0; row < few; ++row) {
            const Vec3 &p = was.position[row], &q = is.position[row], &v = is.velocity[row];
            const Vec3& w = is.angular_velocity[row];
            CHECK((v.x == 0.0 && v.y == 0.0 && v.z == 0.0 && w.x == 0.0 && w.y == 0.0 && w.z == 0.0));
            CHECK((row < statics ? p.z == q.z : q.z < p.z));
            CHECK(is.motion[row] == was.motion[row]);
        }
    }
}

TEST_CASE("pairs of falling bodies become more until the pile is at rest, in which bodies touch", "[host]") {
    for (const scenes::FallingKind& kind : scenes::falling_kinds()) {
        scenes::FallingBodies falling(kind.kind.name, 3 * few, 7);
        const std::size_t fallers = falling.moving();
        const Touches first = touches(falling.scene());
        run_to_rest(falling);
        const Touches last = touches(falling.scene());
        INFO(kind.kind.name << ": " << fallers << " fall, pairs " << first.pairs << " then " << last.pairs
                            << ", touching " << first.touching << " then " << last.touching << ", deepest "
                            << last.deepest);
        CHECK(last.pairs > 2 * first.pairs + fallers);
        CHECK(first.touching < fallers / 4);
        CHECK(last.touching > fallers);
        CHECK(last.touching < 8 * fallers);
        CHECK(last.deepest < 0.5);  // half a body's width and more would be one in the other
    }
}

TEST_CASE("few bodies fall as many do", "[host]") {
    for (const scenes::FallingKind& kind : scenes::falling_kinds())
        for (const std::size_t count : {0u, 1u, 2u, 3u, 10u}) {
            INFO(kind.kind.name << ' ' << count);
            scenes::FallingBodies falling(kind.kind.name, count, 3);
            CHECK(falling.scene().row_count() == count);
            run_to_rest(falling);
            falling.step();
            CHECK(falling.moving() == 0);
            CHECK(falling.scene().rejected().empty());
            const std::size_t touching = touches(falling.scene()).touching;
            if (count < 2) CHECK(touching == 0);
            if (count == 2) CHECK(touching == 1);
        }
}

TEST_CASE("frame 0 of each falling scene is a kind of its own; usual counts are those of the thesis", "[host]") {
    const std::map<std::string, std::size_t> fallers{
        {"cubes-on-plane", 20000}, {"balls-in-bowl", 10000}, {"tori-hulls", 1000}, {"alphabet-hulls", 2600}};
    for (const scenes::FallingKind& kind : scenes::falling_kinds()) {
        INFO(kind.kind.name);
        const scenes::FallingBodies falling(kind.kind.name, kind.usual, 0);
        CHECK(falling.frame() == 0);
        CHECK(falling.scene().row_count() == kind.usual);
        CHECK(falling.moving() == fallers.at(kind.kind.name));
        CHECK(hash(scenes::make_bodies(kind.kind.name, kind.usual, 0)) == hash(falling.scene()));
    }
    CHECK_THROWS_AS(scenes::FallingBodies("mix", 3, 0), Error);
    CHECK_THROWS_WITH(scenes::FallingBodies("cubes", 3, 0),
                      Catch::Contains("'cubes'") && Catch::Contains("tori-hulls, alphabet-hulls"));
    CHECK_THROWS_WITH(scenes::make_bodies("cubes", 3, 0), Catch::Contains("mix, cubes-on-plane"));
}

TEST_CASE("hulls of letters and of the torus have no point that is no corner", "[host]") {
    std::vector<Hull> hulls{scenes::torus_hull()};
    CHECK(hulls[0].points.size() == 80);
    for (std::size_t letter = 0; letter < scenes::letter_count; ++letter) {
        hulls.push_back(scenes::letter_hull(letter));
        double low = 0.0, high = 0.0;
        for (const Vec3& p : hulls.back().points) {
            low = std::min(low, p.y);
            high = std::max(high, p.y);
        }
        CHECK(high - low == Approx(0.9));
    }
    for (const Hull& hull : hulls) {
        CHECK(why_invalid(Shape(hull)).empty());
        CHECK(detail::outermost_points(hull.points).size() == hull.points.size());
        // A pole of the torus is a 16-gon; a letter is a prism: 2 n corners have n + 2 faces.
        const std::size_t faces = detail::hull_faces(hull.points).size();
        CHECK(faces == (hull.points.size() == 80 ? 2 + 4 * 16 : 2 + hull.points.size() / 2));
    }
    CHECK_THROWS_AS(scenes::letter_hull(scenes::letter_count), std::out_of_range);
}
