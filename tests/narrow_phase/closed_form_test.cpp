// The closed forms and the boxes' separating axes in float64, against the oracle.
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/narrow_phase/closed_form_cases.hpp"
// Behind all others: it defines words as short as number().
#include "src/narrow_phase/host_real.hpp"
#define REAL_NAMESPACE host
#include "tests/narrow_phase/closed_form_answer.hpp"

using namespace clinch::test;
using clinch::detail::host::answer;

namespace {

constexpr double unit = 0x1p-53;

TruePair pair_of(Kind a, std::array<double, 3> size_a, Kind b, std::array<double, 3> size_b, std::array<double, 3> at) {
    TruePair pair;
    pair.a.kind = a;
    pair.a.size = size_a;
    pair.b.kind = b;
    pair.b.size = size_b;
    pair.b.position = at;
    return pair;
}

/// The answer, all promises kept.
Answer kept(const TruePair& pair) {
    const Answer got = answer(pair);
    INFO(text_of(pair));
    REQUIRE_THAT(broken_promise(pair, got, unit), Catch::Equals(""));
    return got;
}

double slope(const Answer& got, std::array<double, 3> direction) {
    return got.normal[0] * direction[0] + got.normal[1] * direction[1] + got.normal[2] * direction[2];
}

}  // namespace

TEST_CASE("closed forms in float64 keep what they promise", "[host]") {
    for (const auto& kinds : closed_form_pairs()) {
        const std::uint64_t seed =
            7001 + 10 * static_cast<std::uint64_t>(kinds[0]) + static_cast<std::uint64_t>(kinds[1]);
        Random random(seed);
        const bool boxes = kinds[0] == Kind::box && kinds[1] == Kind::box;
        for (int i = 0; i < (boxes ? 300 : 1000); ++i) {
            const TruePair pair = random_pair(kinds[0], kinds[1], random);
            INFO("seed " << seed << ", case " << i << text_of(pair));
            REQUIRE_THAT(broken_promise(pair, answer(pair), unit), Catch::Equals(""));
        }
    }
}

TEST_CASE("bodies with one centre part along the same direction each time", "[host]") {
    const Answer spheres = kept(pair_of(Kind::sphere, {1}, Kind::sphere, {2}, {}));
    REQUIRE(spheres.distance == -3);
    REQUIRE(spheres.normal == std::array<double, 3>{0, 0, 1});
    REQUIRE(kept(pair_of(Kind::sphere, {1}, Kind::box, {2, 2, 2}, {})).distance == -3);
    REQUIRE(kept(pair_of(Kind::sphere, {1}, Kind::box, {2, 2, 2}, {})).normal == std::array<double, 3>{-1, 0, 0});
    REQUIRE(kept(pair_of(Kind::sphere, {1}, Kind::capsule, {2, 5}, {})).distance == -3);
    REQUIRE(kept(pair_of(Kind::sphere, {1}, Kind::cylinder, {2, 5}, {})).distance == -3);
    REQUIRE(kept(pair_of(Kind::sphere, {1}, Kind::cylinder, {5, 2}, {})).distance == -3);
    REQUIRE(kept(pair_of(Kind::sphere, {1}, Kind::cone, {100, 2}, {})).distance < -2.9);
    REQUIRE(kept(pair_of(Kind::box, {1, 2, 3}, Kind::box, {3, 3, 3}, {})).distance == -4);
    REQUIRE(kept(pair_of(Kind::capsule, {1, 3}, Kind::capsule, {2, 4}, {})).distance == -3);
}

TEST_CASE("capsules on one line, crossing and without length part across both axes", "[host]") {
    TruePair pair = pair_of(Kind::capsule, {0.5, 2}, Kind::capsule, {0.25, 1}, {0, 0, 2.5});
    Answer got = kept(pair);  // their segments share half a unit
    REQUIRE(got.distance == Approx(-0.75).margin(1e-15));
    REQUIRE(std::fabs(slope(got, {0, 0, 1})) < 1e-15);
    pair.b.position[2] = 3;  // end on end
    REQUIRE(kept(pair).distance == Approx(-0.75).margin(1e-15));
    pair.b.position[2] = 4;
    got = kept(pair);
    REQUIRE(got.distance == Approx(0.25).margin(1e-15));
    REQUIRE(slope(got, {0, 0, 1}) == Approx(1).margin(1e-15));
    pair.b.position = {0.5, 0, 0};
    pair.b.rotation = {1, 0, 1, 0};  // along x, through the other's segment
    got = kept(pair);
    REQUIRE(got.distance == Approx(-0.75).margin(1e-15));
    REQUIRE(std::fabs(slope(got, {0, 1, 0})) == Approx(1).margin(1e-15));
    pair.a.size[1] = pair.b.size[1] = 0;  // spheres
    got = kept(pair);
    REQUIRE(got.distance == Approx(-0.25).margin(1e-15));
    REQUIRE(slope(got, {1, 0, 0}) == Approx(1).margin(1e-15));
}

TEST_CASE("nearly parallel capsules that cross", "[host]") {
    for (double angle = 1e-9; angle < 0.02; angle *= 10)
        for (const double gap : {0.0, 1e-12, 1e-6, 1e-2}) {
            TruePair pair = pair_of(Kind::capsule, {0.1, 3}, Kind::capsule, {0.2, 2}, {0, gap, 0.7});
            pair.b.rotation = {1, 0, angle / 2, 0};
            const Answer got = kept(pair);
            REQUIRE(got.distance == Approx(gap - 0.3).margin(1e-14));
            REQUIRE(std::fabs(slope(got, {0, 0, 1})) < 1e-12);
        }
}

TEST_CASE("a small box in the corner of a large one leaves through a face", "[host]") {
    const Answer got = kept(pair_of(Kind::box, {1, 1, 1}, Kind::box, {0.15, 0.15, 0.15}, {1, 1, 1}));
    REQUIRE(got.distance == Approx(-0.15).margin(1e-15));
    REQUIRE(slope(got, {1, 0, 0}) == 1);
    const Answer inside = kept(pair_of(Kind::box, {3, 3, 3}, Kind::box, {0.1, 0.1, 0.1}, {0.5, 0, 0}));
    REQUIRE(inside.distance == Approx(-2.6).margin(1e-15));
    REQUIRE(slope(inside, {1, 0, 0}) == 1);
}

TEST_CASE("plates that cross without a corner in the other touch at a point of both", "[host]") {
    for (const double gap : {0.0, 1e-9, 1e-3, -1e-9, -1e-3})
        for (const double turn : {0.0, 0.2, 0.4142135623730951, 1.0}) {
            TruePair pair = pair_of(Kind::box, {5, 1, 0.05}, Kind::box, {1, 5, 0.05}, {0.25, -0.5, 0.1 + gap});
            pair.b.rotation = {1, 0, 0, turn / 5};
            const Answer plus = kept(pair);
            REQUIRE(plus.distance == Approx(gap).margin(1e-14));
            REQUIRE(slope(plus, {0, 0, 1}) == Approx(1).margin(1e-12));
            pair.a.size = pair.b.size = {1, 1, 0.05};
            pair.b.position = {0, 0, 0.1 + gap};
            pair.b.rotation = {1, 0, 0, turn};  // at 45 degrees an octagon
            REQUIRE(kept(pair).distance == Approx(gap).margin(1e-14));
        }
}

TEST_CASE("boxes all but parallel keep the face's normal", "[host]") {
    for (double angle = 1e-9; angle < 0.02; angle *= 10)
        for (const double depth : {0.1, 1e-3, 0.0, -1e-3}) {
            TruePair pair = pair_of(Kind::box, {5, 5, 0.5}, Kind::box, {0.5, 0.5, 0.5}, {0.3, 0.2, 0});
            pair.b.rotation = {1, angle / 3, angle / 4, 0};
            pair.b.position[2] = 0.5 + 0.5 - depth + 0.6 * angle;
            const Answer got = kept(pair);
            REQUIRE(slope(got, {0, 0, 1}) == Approx(1).margin(1e-9));
        }
}

TEST_CASE("boxes apart at corners and edges: the gap is no axis of theirs", "[host]") {
    const Answer corners = kept(pair_of(Kind::box, {1, 1, 1}, Kind::box, {1, 1, 1}, {3, 3, 3}));
    REQUIRE(corners.distance == Approx(std::sqrt(3.0)).margin(1e-14));
    const Answer edges = kept(pair_of(Kind::box, {1, 1, 1}, Kind::box, {1, 1, 1}, {3, 3, 0.5}));
    REQUIRE(edges.distance == Approx(std::sqrt(2.0)).margin(1e-14));
    TruePair skew = pair_of(Kind::box, {1, 1, 1}, Kind::box, {1, 1, 1}, {0, 3, 3});
    skew.b.rotation = {1, 0.4, 0.4, 0.1};
    REQUIRE(kept(skew).distance > 0);
}
