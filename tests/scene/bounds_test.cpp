#include "src/scene/bounds.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "src/scene/same_bits.hpp"
#include "tests/random.hpp"
#include "tests/scene/bounds_oracle.hpp"

using namespace clinch;
using test::Real;

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

// The `scale` that the growth is stated in.
struct Scale {
    static Real norm1(const Vec3& p) { return std::fabs(p.x) + std::fabs(p.y) + std::fabs(p.z); }
    Real operator()(const Sphere& s) const { return s.radius; }
    Real operator()(const Box& s) const { return norm1(s.half_extents); }
    Real operator()(const Capsule& s) const { return s.radius + s.half_height; }
    Real operator()(const Cylinder& s) const { return s.radius + s.half_height; }
    Real operator()(const Cone& s) const { return s.radius + s.half_height; }
    Real operator()(const Plane&) const { return 0; }
    Real operator()(const Hull& s) const { return largest(s.points); }
    Real operator()(const Mesh& s) const { return largest(s.vertices); }
    static Real largest(const std::vector<Vec3>& points) {
        Real best = 0;
        for (const Vec3& p : points) best = std::max(best, norm1(p));
        return best;
    }
};

// The largest float <= x, which is in float32's range.
float float_below(Real x) {
    const auto f = static_cast<float>(x);
    return static_cast<Real>(f) > x ? std::nextafter(f, -infinity) : f;
}
float float_above(Real x) {
    return -float_below(-x);
}

Aabb box_of(const Shape& shape, const Body& body) {
    Scene scene;
    Body copy = body;
    copy.shape = scene.add_shape(shape);
    scene.add_body(copy);
    detail::HostBounds bounds;
    bounds.update(scene);
    REQUIRE(scene.rejected().empty());
    return bounds.boxes()[0];
}

// Checks the box of every row against the exact one; returns how many growths were checked.
void check_scene(const Scene& scene) {
    detail::HostBounds bounds;
    bounds.update(scene);
    REQUIRE(bounds.boxes().size() == scene.row_count());
    for (std::uint32_t row = 0; row < scene.row_count(); ++row) {
        const Aabb& box = bounds.boxes()[row];
        const Body body = scene.body({row});
        const Shape& shape = scene.shape(body.shape);
        const test::ExactBox exact = test::exact_box(shape, body);
        const Real scale = std::visit(Scale{}, shape);
        const Real p[3] = {body.pose.position.x, body.pose.position.y, body.pose.position.z};
        for (std::size_t i = 0; i < 3; ++i) {
            INFO("row " << row << " class " << shape.index() << " axis " << i << " position " << double(p[i]));
            const Real magnitude = std::fabs(p[i]) + scale + body.margin;
            const Real oracle_error = magnitude * 0x1p-60L;
            CHECK(static_cast<Real>(box.min[i]) <= exact.min[i] + oracle_error);
            CHECK(static_cast<Real>(box.max[i]) >= exact.max[i] - oracle_error);
            // As stated in cl/common/bounds.clh, plus the margin's rounding and what 48 bits of position leave.
            const Real grow = scale * 0x1p-19L + body.margin * 0x1p-23L + std::fabs(p[i]) * 0x1p-46L + 0x1p-86L;
            CHECK(box.min[i] >= std::nextafter(float_below(exact.min[i] - grow - oracle_error), -infinity));
            CHECK(box.max[i] <= std::nextafter(float_above(exact.max[i] + grow + oracle_error), infinity));
        }
    }
}

}  // namespace

TEST_CASE("bounds hold the exact shape and hardly more, on hostile bodies", "[host]") {
    const std::uint64_t seed = GENERATE(1u, 2u, 3u, 4u);
    INFO("seed " << seed);
    const Scene scene = test::hostile_scene(7000, seed);
    // Hulls of four hostile points and the like may have no volume; nearly all bodies must count.
    const auto& rejected = scene.rejected();
    INFO("first rejection: " << (rejected.empty() ? "" : rejected.front().why));
    REQUIRE(rejected.empty());
    check_scene(scene);
}

TEST_CASE("bounds of unrotated bodies with float32 numbers are exact", "[host]") {
    test::Random random(5);
    const std::size_t kind = GENERATE(0u, 1u, 2u, 3u, 4u, 6u);
    for (int n = 0; n < 500; ++n) {
        // Multiples of 1/64 whose sums float32 holds.
        const auto number = [&](std::uint64_t most) { return static_cast<double>(1 + random.below(64 * most)) / 64; };
        Shape shape = Sphere{number(8)};
        if (kind == 1) shape = Box{{number(8), number(8), number(8)}};
        if (kind == 2) shape = Capsule{number(8), number(8)};
        if (kind == 3) shape = Cylinder{number(8), number(8)};
        if (kind == 4) shape = Cone{number(8), number(8)};
        if (kind == 6) {
            Hull hull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
            for (int k = 0; k < 40; ++k) hull.points.push_back({number(8) - 4, number(8) - 4, number(8) - 4});
            shape = hull;
        }
        Body body;
        body.pose.position = {number(4096) - 2048, number(4096) - 2048, number(4096) - 2048};
        body.margin = random.below(2) == 0 ? 0.0 : number(4);
        const Aabb box = box_of(shape, body);
        const test::ExactBox exact = test::exact_box(shape, body);
        for (std::size_t i = 0; i < 3; ++i) {
            CHECK(static_cast<Real>(box.min[i]) == exact.min[i]);
            CHECK(static_cast<Real>(box.max[i]) == exact.max[i]);
        }
    }
}

TEST_CASE("bounds of bodies turned axis to axis are exact", "[host]") {
    constexpr double h = 0.70710678118654752440;
    const Quat quarter = GENERATE_COPY(Quat{h, h, 0, 0}, Quat{h, 0, -h, 0}, Quat{0.7071068, 0, 0, 0.7071068},
                                       Quat{0, h, h, 0}, Quat{.5, .5, -.5, .5}, Quat{0, 1, 0, 0}, Quat{-1, 0, 0, 0});
    Body body;
    body.pose.position = {1000.25, -3.5, 0.125};
    body.pose.rotation = quarter;
    const Shape shapes[] = {Box{{1, 2, 4}}, Capsule{1, 2}, Cylinder{1, 2}, Cone{0.25, 2},
                            Hull{{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 4}}}};
    for (const Shape& shape : shapes) {
        const Aabb box = box_of(shape, body);
        const test::ExactBox exact = test::exact_box(shape, body);
        for (std::size_t i = 0; i < 3; ++i) {
            INFO("class " << shape.index() << " axis " << i);
            CHECK(std::fabs(static_cast<Real>(box.min[i]) - exact.min[i]) <= 1e-15L);
            CHECK(std::fabs(static_cast<Real>(box.max[i]) - exact.max[i]) <= 1e-15L);
        }
    }
}

TEST_CASE("a position that float32 cannot hold is rounded outward once", "[host]") {
    test::Random random(6);
    std::size_t nearest = 0, faces = 0;
    for (int n = 0; n < 2000; ++n) {
        Body body;
        const double spread = n % 2 == 0 ? 10.0 : 1e7;
        body.pose.position = {random.between(-spread, spread), random.between(-spread, spread),
                              random.between(-spread, spread)};
        const Shape shape = Box{{0.25, 0.5, 4.0}};
        const Aabb box = box_of(shape, body);
        const test::ExactBox exact = test::exact_box(shape, body);
        for (std::size_t i = 0; i < 3; ++i) {
            const float low = float_below(exact.min[i]), high = float_above(exact.max[i]);
            CHECK(box.min[i] <= low);
            CHECK(box.max[i] >= high);
            CHECK(box.min[i] >= std::nextafter(low, -infinity));
            CHECK(box.max[i] <= std::nextafter(high, infinity));
            nearest += (box.min[i] == low ? 1u : 0u) + (box.max[i] == high ? 1u : 0u);
            faces += 2;
        }
    }
    CHECK(nearest >= faces * 999 / 1000);
}

TEST_CASE("touching boxes far from the origin still touch", "[host]") {
    // A unit grid 1e7 away: neighbours share a face exactly, so that no growth may separate or merge them.
    const auto at = [](double x) {
        Body body;
        body.pose.position = {1e7 + x, 0, 0};
        return box_of(Box{{0.5, 0.5, 0.5}}, body);
    };
    CHECK(overlap(at(0.5), at(1.5)));
    CHECK_FALSE(overlap(at(0.5), at(2.5)));
    CHECK(at(0.5).max[0] == 10000001.0f);
}

TEST_CASE("a sphere's box does not depend on its rotation", "[host]") {
    test::Random random(7);
    Body body;
    body.pose.position = {0.1, 0.2, 0.3};
    const Aabb still = box_of(Sphere{0.7}, body);
    body.pose.rotation = test::random_rotation(random);
    const Aabb spun = box_of(Sphere{0.7}, body);
    CHECK(detail::same_bits(still, spun));
}

TEST_CASE("the square root of the bounds kernel is within 3u everywhere", "[host]") {
    // Every mantissa of two binades; other x give the same digits, since nothing rounds differently there.
    double worst = 0.0;
    for (std::uint32_t bits = detail::as_uint(0.25f); bits < detail::as_uint(1.0f); ++bits) {
        const float x = detail::as_float(bits);
        const double root = std::sqrt(static_cast<double>(x));
        worst = std::max(worst, std::fabs(static_cast<double>(detail::clinch_root(x)) - root) / root);
    }
    CHECK(worst <= 3.0 * 0x1p-24);
    test::Random random(8);
    for (int n = 0; n < 100000; ++n) {
        const auto x = static_cast<float>(random.between(0.25, 1.0));
        const float root = detail::clinch_root(x);
        CHECK(detail::clinch_root(x * 0x1p-58f) == root * 0x1p-29f);
        CHECK(detail::clinch_root(x * 0x1p-20f) == root * 0x1p-10f);
    }
    CHECK(detail::clinch_root(0.0f) == detail::clinch_root(0x1p-60f));
    CHECK(std::fabs(detail::clinch_root(0x1p-60f) - 0x1p-30f) <= 0x1p-52f);
    CHECK(std::fabs(detail::clinch_root(1.999f) - 1.41386f) < 1e-5f);
}

TEST_CASE("sums rounded up are the smallest float not below the exact sum", "[host]") {
    test::Random random(9);
    std::size_t exact_sums = 0;
    for (int n = 0; n < 200000; ++n) {
        const auto a = static_cast<float>(random.between(-1, 1));
        const auto b = static_cast<float>(random.between(-1, 1) * std::pow(2.0, random.between(-30, 30)));
        const Real sum = static_cast<Real>(a) + static_cast<Real>(b);
        if (static_cast<Real>(static_cast<float>(sum)) == sum) ++exact_sums;
        CHECK(detail::clinch_add_up(a, b) == float_above(sum));
    }
    CHECK(exact_sums > 1000);
    CHECK(detail::clinch_add_up(1.0f, -1.0f) == 0.0f);
    CHECK(detail::clinch_add_up(-1.0f, 0x1p-40f) == std::nextafter(-1.0f, 0.0f));
}

TEST_CASE("host bounds look again only at changed rows", "[host]") {
    Scene scene = test::hostile_scene(5000, 10);
    detail::HostBounds bounds;
    CHECK(bounds.update(scene) == 5000);
    CHECK(bounds.update(scene) == 0);
    const std::vector<Aabb> before(bounds.boxes().begin(), bounds.boxes().end());
    scene.set_pose({7}, {{1, 2, 3}, {}});
    scene.remove_body({4000});
    scene.set_motion({8}, static_cast<Motion>(9));  // rejected: its box goes
    scene.set_motion({9}, Motion::Static);          // of no concern
    CHECK(bounds.update(scene) == 3);
    CHECK(std::isnan(bounds.boxes()[4000].min[0]));
    CHECK(std::isnan(bounds.boxes()[8].max[2]));
    CHECK(detail::same_bits(bounds.boxes()[9], before[9]));
    scene.set_motion({8}, Motion::Dynamic);
    CHECK(bounds.update(scene) == 1);
    CHECK(detail::same_bits(bounds.boxes()[8], before[8]));
    const Scene copy = scene;
    CHECK(bounds.update(copy) == 5000);
    CHECK(bounds.update(scene) == 5000);
}
