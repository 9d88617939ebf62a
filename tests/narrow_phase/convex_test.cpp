// The general convex routine in float64 against oracles: everything tried for polytopes, a search over directions for
// cylinders and cones.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

// Behind all others: it defines words as short as number().
#include "src/narrow_phase/host_real.hpp"
#define REAL_NAMESPACE host
#include "tests/narrow_phase/convex_answer.hpp"

using namespace clinch;
using namespace clinch::test;
using detail::host::convex_answer;

namespace {

constexpr double unit = 0x1p-53;
constexpr Regime regimes[] = {Regime::any,
                              Regime::flat,
                              Regime::unequal,
                              Regime::parallel,
                              Regime::nearly_parallel,
                              Regime::concentric,
                              Regime::nearly_concentric,
                              Regime::far_scale};
constexpr std::uint32_t classes[] = {0, 1, 2, 3, 4, 6};

bool curved(std::uint32_t kind) {
    return kind == 3 || kind == 4;
}

ConvexBody box(double x, double y, double z, Vec3 at = {}, Quat turn = {}) {
    return {1, {x, y, z}, {}, turn, at};
}

Quat about(const Vec3& axis, double angle) {
    const double s = std::sin(angle / 2);
    return {std::cos(angle / 2), axis.x * s, axis.y * s, axis.z * s};
}

// The pair again, moved along the normal to a distance of 1e-14 to 1e-3 of its size, or to touch.
ConvexBodies brought_to_touch(ConvexBodies pair, const ConvexAnswer& answer, Random& random) {
    const double want = random.below(3) == 0 ? 0.0 : std::pow(10.0, random.between(-14, -3)) * size_of(pair);
    move(pair.b, answer.normal, (random.below(2) == 0 ? want : -want) - answer.distance);
    return pair;
}

// Of a normal that runs along z, how far it is off.
double off_z(const ConvexAnswer& answer) {
    return std::hypot(answer.normal[0], answer.normal[1]);
}

}  // namespace

TEST_CASE("convex routine: polytopes, spheres and capsules answer what trying everything does", "[host]") {
    for (const std::uint32_t a : classes)
        for (const std::uint32_t b : classes) {
            if (a > b || curved(a) || curved(b)) continue;
            const std::uint64_t seed = 4000 + 10 * a + b;
            Random random(seed);
            for (const Regime regime : regimes) {
                // Rounding bends slivers there: the answer says by how much, and another test looks closer.
                const bool bent = regime == Regime::nearly_parallel;
                const bool thin = regime == Regime::flat || regime == Regime::unequal;
                for (int i = 0; i < 100 && !bent; ++i) {
                    ConvexBodies pair = random_bodies(a, b, regime, random);
                    for (int touching = 0; touching < 2; ++touching) {
                        const ConvexAnswer answer = convex_answer(pair);
                        INFO("seed " << seed << ", regime " << static_cast<int>(regime) << ", case " << i
                                     << text_of(pair));
                        REQUIRE_THAT(broken_promise(pair, answer, unit, 8 * unit, false, random), Catch::Equals(""));
                        // Where thin or tiny bodies touch, triangles are slivers.
                        REQUIRE(answer.error <= (thin || touching == 1 ? 1e5 : 80) * unit * size_of(pair));
                        REQUIRE(static_cast<double>(witness_error(pair, answer)) <= 4 * answer.error);
                        pair = brought_to_touch(pair, answer, random);
                    }
                }
            }
        }
}

TEST_CASE("convex routine: nearly parallel polytopes, against 113 bits", "[host]") {
    for (const std::uint32_t a : {0u, 1u, 2u})
        for (const std::uint32_t b : {1u, 2u}) {
            if (a > b) continue;
            const std::uint64_t seed = 5000 + 10 * a + b;
            Random random(seed);
            for (int i = 0; i < 60; ++i) {
                const ConvexBodies pair = random_bodies(a, b, Regime::nearly_parallel, random);
                const ConvexAnswer answer = convex_answer(pair);
                INFO("seed " << seed << ", case " << i << text_of(pair));
                REQUIRE_THAT(broken_promise(pair, answer, unit, 1e-6, true, random), Catch::Equals(""));
                REQUIRE(answer.error <= 1e-6 * size_of(pair));
            }
        }
}

TEST_CASE("convex routine: cylinders and cones within the tolerance", "[host]") {
    for (const std::uint32_t a : classes)
        for (const std::uint32_t b : classes) {
            if (a > b || !(curved(a) || curved(b))) continue;
            const std::uint64_t seed = 6000 + 10 * a + b;
            Random random(seed);
            for (const Regime regime : regimes) {
                // Around a common axis all directions tie, and a polytope of so many corners is only so round.
                const bool ties = regime != Regime::any && regime != Regime::flat && regime != Regime::far_scale;
                for (int i = 0; i < 40; ++i) {
                    ConvexBodies pair = random_bodies(a, b, regime, random);
                    for (int touching = 0; touching < 2; ++touching) {
                        const ConvexAnswer answer = convex_answer(pair);
                        INFO("seed " << seed << ", regime " << static_cast<int>(regime) << ", case " << i
                                     << text_of(pair));
                        REQUIRE_THAT(broken_promise(pair, answer, unit, 1e-10, false, random), Catch::Equals(""));
                        REQUIRE(answer.error <= (ties ? 4e-3 : touching == 1 ? 1e-8 : 1.5e-10) * size_of(pair));
                        REQUIRE(static_cast<double>(witness_error(pair, answer)) <=
                                2 * answer.error + (answer.distance > 0 ? 1e-9 : 1e-3) * size_of(pair));
                        pair = brought_to_touch(pair, answer, random);
                    }
                }
            }
        }
}

TEST_CASE("convex routine: the swapped pair gives the mirrored answer", "[host]") {
    Random random(7001);
    for (const std::uint32_t kind : {1u, 3u, 4u, 6u})
        for (int i = 0; i < 100; ++i) {
            const ConvexBodies pair = random_bodies(kind, kind, Regime::any, random);
            const ConvexAnswer there = convex_answer(pair), back = convex_answer({pair.b, pair.a});
            INFO("seed 7001, kind " << kind << ", case " << i << text_of(pair));
            REQUIRE(std::fabs(there.distance - back.distance) <= there.error + back.error);
        }
}

TEST_CASE("convex routine: a limit and a tolerance shorten the work, not the truth", "[host]") {
    Random random(7002);
    int early = 0, coarse = 0;
    for (int i = 0; i < 300; ++i) {
        const ConvexBodies pair = random_bodies(i % 2 == 0 ? 6 : 1, 6, Regime::any, random);
        const ConvexAnswer full = convex_answer(pair);
        const ConvexAnswer limited = convex_answer(pair, 0.01, 0.0), rough = convex_answer(pair, 1e300, 1e-3);
        INFO("seed 7002, case " << i << text_of(pair));
        REQUIRE(std::fabs(limited.distance - full.distance) <= limited.error + full.error);
        REQUIRE(std::fabs(rough.distance - full.distance) <= rough.error + full.error);
        REQUIRE(rough.error <= 2e-3 * size_of(pair));
        // What is left unfinished is surely above the limit.
        if (limited.error > 100 * unit * size_of(pair)) {
            REQUIRE(limited.distance - limited.error > 0.01 - 100 * unit * size_of(pair));
            ++early;
        }
        if (rough.error > 1e-5 * size_of(pair)) ++coarse;
    }
    REQUIRE(early > 10);
    REQUIRE(coarse > 10);
}

TEST_CASE("convex routine: faces, edges and corners that touch", "[host]") {
    for (const double s : {0.01, 1.0, 1000.0})
        for (const Quat& turn : {Quat{}, about({0, 0, 1}, 0.7), about({0.6, 0, 0.8}, 1.1)})
            for (int corner = 0; corner < 3; ++corner) {
                // Along the axes of the turned boxes, by their turned frame.
                ConvexBodies pair{box(s, s, s, {}, turn), box(s, s, s, {}, turn)};
                const std::array<double, 3> way{2 * s, corner > 0 ? 2 * s : 0.3 * s, corner > 1 ? 2 * s : -0.2 * s};
                const double x = turn.x, y = turn.y, z = turn.z, w = turn.w;
                const double m[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                                     2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                                     2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
                pair.b.position = {m[0] * way[0] + m[1] * way[1] + m[2] * way[2],
                                   m[3] * way[0] + m[4] * way[1] + m[5] * way[2],
                                   m[6] * way[0] + m[7] * way[1] + m[8] * way[2]};
                const ConvexAnswer answer = convex_answer(pair);
                INFO("corner " << corner << text_of(pair));
                Random random(1);
                REQUIRE_THAT(broken_promise(pair, answer, unit, 8 * unit, false, random), Catch::Equals(""));
                REQUIRE(std::fabs(answer.distance) <= answer.error);
                REQUIRE(answer.error <= 80 * unit * size_of(pair));
            }
}

TEST_CASE("convex routine: deep and contained bodies", "[host]") {
    // In the corner of a large box, out by a face and not along the diagonal.
    const ConvexAnswer corner = convex_answer({box(1, 1, 1), box(0.05, 0.05, 0.05, {0.9, 0.9, 0.9})});
    CHECK(corner.distance == Approx(-0.15).epsilon(1e-14));
    CHECK(std::fabs(std::fabs(corner.normal[0] + corner.normal[1] + corner.normal[2]) - 1.0) < 1e-14);
    // Concentric: out by the shortest side; every time the same.
    const ConvexBodies concentric{box(1, 2, 3), box(0.5, 0.25, 0.125)};
    const ConvexAnswer out = convex_answer(concentric);
    CHECK(out.distance == Approx(-1.5).epsilon(1e-14));
    CHECK(std::fabs(std::fabs(out.normal[0]) - 1.0) < 1e-14);
    CHECK(convex_answer(concentric).normal == out.normal);
    // A sphere sunk below a box's face.
    CHECK(convex_answer({{0, {0.5}, {}, {}, {}}, box(2, 2, 1, {0, 0, -0.9})}).distance == Approx(-0.6).epsilon(1e-14));
    // Identical spheres, one in the other.
    CHECK(convex_answer({{0, {2.0}, {}, {}, {}}, {0, {2.0}, {}, {}, {}}}).distance == -4.0);
    // Capsules with axes that cross, and with axes one in the other.
    CHECK(convex_answer({{2, {0.1, 1.0}, {}, {}, {}}, {2, {0.2, 1.0}, {}, about({1, 0, 0}, 1.0), {}}}).distance ==
          Approx(-0.3).epsilon(1e-14));
    CHECK(convex_answer({{2, {0.1, 1.0}, {}, {}, {}}, {2, {0.2, 1.0}, {}, {}, {0, 0, 0.5}}}).distance ==
          Approx(-0.3).epsilon(1e-14));
}

TEST_CASE("convex routine: between parallel faces the normal stays the faces'", "[host]") {
    for (const double angle : {0.0, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2}) {
        INFO("angle " << angle);
        // A thin plate sunk into a slab, turned about their common normal.
        const ConvexAnswer sunk =
            convex_answer({box(2, 2, 0.5), box(1, 1, 0.001, {0.1, 0.2, 0.4}, about({0, 0, 1}, angle))});
        CHECK(std::fabs(sunk.distance + 0.101) <= sunk.error + 1e-15);
        CHECK(off_z(sunk) < 1e-7);
        // A stack, overlapping a little and apart a little.
        for (const double gap : {-1e-3, 1e-3}) {
            const ConvexAnswer stack =
                convex_answer({box(1, 1, 1), box(1, 1, 1, {0.1, 0.2, 2 + gap}, about({0, 0, 1}, angle))});
            CHECK(std::fabs(stack.distance - gap) <= stack.error + 1e-15);
            CHECK(off_z(stack) < 1e-7);
        }
    }
}

TEST_CASE("convex routine: tips, rims and sides of cylinders and cones", "[host]") {
    const ConvexBody plate = box(2, 2, 0.001);
    // A lying cylinder 1e-8 above a plate, a standing cone, a cone on its tip, both sunk a little.
    const ConvexAnswer lying =
        convex_answer({plate, {3, {0.5, 1.0}, {}, about({1, 0, 0}, 1.5707963267948966), {0, 0, 0.501 + 1e-8}}});
    CHECK(std::fabs(lying.distance - 1e-8) <= lying.error);
    CHECK(lying.error < 1e-9);
    for (const bool tip : {false, true}) {
        const Quat turn = tip ? Quat{0, 1, 0, 0} : Quat{};
        const ConvexAnswer above = convex_answer({plate, {4, {0.5, 1.0}, {}, turn, {0.1, 0.2, 1.001 + 1e-6}}});
        CHECK(std::fabs(above.distance - 1e-6) <= above.error + 1e-15);
        CHECK(above.error < 2e-9);
        const ConvexAnswer below = convex_answer({plate, {4, {0.5, 1.0}, {}, turn, {0.1, 0.2, 1.001 - 1e-4}}});
        CHECK(std::fabs(below.distance + 1e-4) <= below.error + 1e-15);
        CHECK(below.error < 2e-9);
        CHECK(off_z(below) < 1e-4);
    }
}
