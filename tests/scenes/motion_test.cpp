// Frames of scenes in which some boxes move.
#include "bench/scenes/motion.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "bench/scenes/boxes.hpp"
#include "clinch/error.hpp"
#include "tests/broad_phase/oracle.hpp"

using namespace clinch;

namespace {

bool same(const Aabb& p, const Aabb& q) {
    return std::memcmp(&p, &q, sizeof(Aabb)) == 0;
}

}  // namespace

TEST_CASE("the share of boxes asked for moves, each by 1 % of its side a frame", "[host]") {
    const std::vector<Aabb> first = scenes::make_boxes("sparse-motion", 5000, 3);
    for (const double fraction : {0.0, 0.01, 0.5, 1.0}) {
        INFO(fraction);
        scenes::SparseMotion motion(first, fraction, 9);
        REQUIRE(motion.movers().size() == static_cast<std::size_t>(std::lround(fraction * 5000)));
        CHECK(std::is_sorted(motion.movers().begin(), motion.movers().end()));
        const Aabb* const place = motion.boxes().data();
        for (int frame = 0; frame < 5; ++frame) {
            const std::vector<Aabb> before = motion.boxes();
            motion.step();
            CHECK(motion.boxes().data() == place);
            std::vector<std::uint32_t> moved;
            for (std::uint32_t i = 0; i < 5000; ++i) {
                if (same(before[i], motion.boxes()[i])) continue;
                moved.push_back(i);
                double square = 0.0;
                for (int d = 0; d < 3; ++d) {
                    const double by = double{motion.boxes()[i].min[d]} - double{before[i].min[d]};
                    square += by * by;
                }
                REQUIRE(std::sqrt(square) == Approx(0.01).epsilon(0.001));
            }
            CHECK(moved == motion.movers());
        }
    }
}

TEST_CASE("a box moves along each axis in proportion to its side there", "[host]") {
    const std::vector<Aabb> first(100, Aabb{{0, 0, 0}, {1000, 1, 0}});
    scenes::SparseMotion motion(first, 1.0, 2);
    motion.step();
    double most = 0.0;
    for (const Aabb& box : motion.boxes()) {
        CHECK(box.min[2] == 0.0f);
        CHECK(std::fabs(box.min[1]) <= 0.01f);
        CHECK(std::fabs(box.min[0]) <= 10.0f);
        most = std::max(most, std::fabs(double{box.min[0]}));
    }
    CHECK(most > 5.0);
}

TEST_CASE("frames are the same bytes on every machine, and differ by the seed", "[host]") {
    const std::vector<Aabb> first = scenes::make_boxes("sparse-motion", 1000, 1);
    const auto after = [&](std::uint64_t seed) {
        scenes::SparseMotion motion(first, 0.1, seed);
        for (int frame = 0; frame < 50; ++frame) motion.step();
        std::uint64_t hash = 1469598103934665603u;
        std::vector<unsigned char> bytes(first.size() * sizeof(Aabb));
        std::memcpy(bytes.data(), motion.boxes().data(), bytes.size());
        for (const unsigned char b : bytes) hash = (hash ^ b) * 1099511628211u;
        return hash;
    };
    CHECK(after(1) == 0xe28d330055696ca7u);
    CHECK(after(2) != after(1));
}

TEST_CASE("movers stay where the scene was and keep their sides", "[host]") {
    const std::vector<Aabb> first = scenes::make_boxes("sparse-motion", 2000, 6);
    const double edge = std::cbrt(4.0 * 2000.0);
    scenes::SparseMotion motion(first, 1.0, 4);
    const double pairs = static_cast<double>(test::pairs_by_sweep(first).size());
    for (int frame = 0; frame < 3000; ++frame) motion.step();
    for (const Aabb& box : motion.boxes())
        for (int d = 0; d < 3; ++d) {
            REQUIRE(double{box.max[d]} - double{box.min[d]} == Approx(1.0).margin(1e-5));
            REQUIRE(box.min[d] > -0.51);
            REQUIRE(box.max[d] < edge + 0.51);
        }
    CHECK(static_cast<double>(test::pairs_by_sweep(motion.boxes()).size()) == Approx(pairs).epsilon(0.25));
    CHECK_FALSE(same(motion.boxes()[0], first[0]));
}

TEST_CASE("no boxes move as well; a fraction that is none is refused", "[host]") {
    scenes::SparseMotion empty({}, 1.0, 0);
    empty.step();
    CHECK(empty.boxes().empty());
    for (const double fraction : {-0.1, 1.1, std::nan("")})
        CHECK_THROWS_AS(scenes::SparseMotion(std::vector<Aabb>(3), fraction, 0), Error);
}

TEST_CASE("random rotations turn without stretching, to every side alike", "[host]") {
    scenes::Random random(3);
    std::array<double, 3> mean{};
    for (int i = 0; i < 2000; ++i) {
        const auto r = random.rotation();
        for (std::size_t p = 0; p < 3; ++p) {
            mean[p] += std::fabs(r[p][0]) / 2000.0;
            for (std::size_t q = 0; q < 3; ++q) {
                const double dot = r[p][0] * r[q][0] + r[p][1] * r[q][1] + r[p][2] * r[q][2];
                REQUIRE(dot == Approx(p == q ? 1.0 : 0.0).margin(1e-12));
            }
        }
        const double det = r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) -
                           r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0]) +
                           r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]);
        REQUIRE(det == Approx(1.0));
    }
    for (const double m : mean) CHECK(m == Approx(0.5).epsilon(0.05));
}
