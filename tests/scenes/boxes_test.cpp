// The generated box scenes: the same bytes everywhere, and about as many pairs as they promise.
#include "bench/scenes/boxes.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "clinch/error.hpp"

namespace {

using clinch::Aabb;
using clinch::scenes::make_boxes;

/// FNV-1a over the bytes.
std::uint64_t hash(const std::vector<Aabb>& boxes) {
    std::vector<unsigned char> bytes(boxes.size() * sizeof(Aabb));
    std::memcpy(bytes.data(), boxes.data(), bytes.size());
    std::uint64_t h = 1469598103934665603u;
    for (const unsigned char b : bytes) h = (h ^ b) * 1099511628211u;
    return h;
}

std::uint64_t count_pairs(const std::vector<Aabb>& boxes) {
    std::uint64_t pairs = 0;
    for (std::size_t a = 0; a < boxes.size(); ++a)
        for (std::size_t b = a + 1; b < boxes.size(); ++b) pairs += clinch::overlap(boxes[a], boxes[b]) ? 1u : 0u;
    return pairs;
}

double side(const Aabb& box, int axis) {
    return double{box.max[axis]} - double{box.min[axis]};
}
double middle(const Aabb& box, int axis) {
    return 0.5 * (double{box.max[axis]} + double{box.min[axis]});
}

/// Pairs to expect of cubes of these sides whose centres are uniform in a cube of this edge.
double expected_pairs(const std::vector<Aabb>& boxes, double edge) {
    double sum = 0.0;
    for (std::size_t a = 0; a < boxes.size(); ++a)
        for (std::size_t b = a + 1; b < boxes.size(); ++b) {
            const double reach = 0.5 * (side(boxes[a], 0) + side(boxes[b], 0)) / edge;
            sum += std::pow(2.0 * reach - reach * reach, 3.0);
        }
    return sum;
}

/// The same of `mixed`, its planets being where they are: debris has its centre near enough to one of them
/// as often as the part of the scene says that is near enough.
double expected_mixed_pairs(const std::vector<Aabb>& boxes, double edge) {
    std::vector<Aabb> debris;
    double sum = 0.0;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        if (i % 1000 != 0) debris.push_back(boxes[i]);
        for (std::size_t j = 0; i % 1000 == 0 && j < boxes.size(); ++j) {
            if (j % 1000 == 0) {
                sum += j > i && clinch::overlap(boxes[i], boxes[j]) ? 1.0 : 0.0;
                continue;
            }
            double share = 1.0;
            for (int axis = 0; axis < 3; ++axis) {
                const double reach = 0.5 * (side(boxes[i], axis) + side(boxes[j], axis));
                const double centre = middle(boxes[i], axis);
                share *= (std::min(centre + reach, edge) - std::max(centre - reach, 0.0)) / edge;
            }
            sum += share;
        }
    }
    return sum + expected_pairs(debris, edge);
}

}  // namespace

TEST_CASE("box scenes are the same bytes on every machine", "[host]") {
    const std::map<std::string, std::uint64_t> known{
        {"uniform", 0xdfc1bb0120102587u},      {"cubes", 0xff96d681ab32810du},    {"density", 0xb63ffea7329cfd3bu},
        {"mixed", 0x864a698e196efc54u},        {"clusters", 0xac2d6b57ac57a82du}, {"surface", 0xcda27e36c1ba4894u},
        {"plane", 0xaa1298dbf418f60cu},        {"line", 0x170d0f401266bb47u},     {"identical", 0xfb2eff01747760c3u},
        {"grid-touch", 0x5c6c6311ffe3b513u},   {"far", 0x9f07495b76627489u},      {"far6", 0x47e30e7dc0ff5504u},
        {"sparse-motion", 0xb63ffea7329cfd3bu}};
    REQUIRE(clinch::scenes::box_kinds().size() == known.size());
    for (const clinch::scenes::BoxKind& kind : clinch::scenes::box_kinds()) {
        INFO(kind.name);
        REQUIRE(known.count(kind.name) == 1);
        CHECK(hash(make_boxes(kind.name, 1000, 0)) == known.at(kind.name));
        CHECK(hash(make_boxes(kind.name, 1000, 1)) != known.at(kind.name));
        CHECK(std::strlen(kind.what) > 10);
    }
}

TEST_CASE("box scenes have about as many pairs as chance says", "[host]") {
    const std::size_t n = 3000;
    const std::map<std::string, double> edges{
        {"uniform", 20.0}, {"cubes", 20.0}, {"density", std::cbrt(4.0 * double{n})}, {"mixed", 50.0}};
    for (const auto& [kind, edge] : edges)
        for (const std::uint64_t seed : {1u, 2u, 3u}) {
            INFO(kind << " seed " << seed);
            const std::vector<Aabb> boxes = make_boxes(kind, n, seed);
            const double expected = kind == "mixed" ? expected_mixed_pairs(boxes, edge) : expected_pairs(boxes, edge);
            const double spread = 5.0 * std::sqrt(expected);
            CHECK(static_cast<double>(count_pairs(boxes)) == Approx(expected).margin(spread));
        }
}

TEST_CASE("box scenes keep their sides and places", "[host]") {
    struct Row {
        const char* kind;
        double low, high, edge;
    };
    const std::size_t n = 2000;
    for (const Row& row : {Row{"uniform", 0.01, 1.0, 20.0}, Row{"cubes", 0.5, 0.5, 20.0},
                           Row{"density", 1.0, 1.0, std::cbrt(4.0 * double{n})}, Row{"mixed", 0.01, 20.0, 50.0}}) {
        INFO(row.kind);
        const std::vector<Aabb> boxes = make_boxes(row.kind, n, 7);
        double least = 1e9, most = 0.0;
        for (const Aabb& box : boxes)
            for (int axis = 0; axis < 3; ++axis) {
                least = std::min(least, side(box, axis));
                most = std::max(most, side(box, axis));
                REQUIRE(middle(box, axis) > -1e-5);
                REQUIRE(middle(box, axis) < row.edge + 1e-5);
            }
        CHECK(least > row.low - 1e-5);
        CHECK(most < row.high + 1e-5);
        CHECK(most - least >= 0.8 * (row.high - row.low) - 1e-5);
    }
    const std::vector<Aabb> mixed = make_boxes("mixed", n, 7);
    for (std::size_t i = 0; i < n; ++i) REQUIRE((side(mixed[i], 1) > 0.9) == (i % 1000 == 0));
}

TEST_CASE("clusters have four pairs a body and never mix", "[host]") {
    const std::size_t n = 4000;
    const double deviation = std::cbrt(double{n} / 160.0) / std::sqrt(std::acos(-1.0));
    const double in_cluster = double{n} / 20.0;
    const double expected = 20.0 * 0.5 * in_cluster * (in_cluster - 1.0) * std::pow(std::erf(0.5 / deviation), 3.0);
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        INFO("seed " << seed);
        const std::vector<Aabb> boxes = make_boxes("clusters", n, seed);
        std::uint64_t pairs = 0, across = 0;
        for (std::size_t a = 0; a < n; ++a)
            for (std::size_t b = a + 1; b < n; ++b)
                if (clinch::overlap(boxes[a], boxes[b])) ++(a % 20 == b % 20 ? pairs : across);
        CHECK(across == 0);
        CHECK(static_cast<double>(pairs) == Approx(expected).epsilon(0.06));
        CHECK(static_cast<double>(pairs) == Approx(4.0 * double{n}).epsilon(0.2));
    }
}

TEST_CASE("a generator gives the boxes one by one, and refuses an unknown kind", "[host]") {
    clinch::scenes::BoxGenerator generator("density", 50, 3);
    std::vector<Aabb> one_by_one(50);
    for (Aabb& box : one_by_one) box = generator.next();
    CHECK(hash(one_by_one) == hash(make_boxes("density", 50, 3)));
    for (const clinch::scenes::BoxKind& kind : clinch::scenes::box_kinds()) CHECK(make_boxes(kind.name, 0, 0).empty());
    CHECK_THROWS_AS(make_boxes("unifrom", 1, 0), clinch::Error);
    CHECK_THROWS_WITH(make_boxes("unifrom", 1, 0), Catch::Contains("unifrom") && Catch::Contains("uniform"));
}

TEST_CASE("cube roots are right to the last bits without the mathematical library", "[host]") {
    for (const double x : {1e-9, 0.3, 1.0, 8.0, 27.0, 4e3, 4e9, 1.7e10}) {
        INFO(x);
        CHECK(clinch::scenes::cube_root(x) == Approx(std::cbrt(x)).epsilon(1e-15));
    }
    CHECK(clinch::scenes::cube_root(0.0) == 0.0);
}
