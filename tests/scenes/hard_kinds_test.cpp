// The kinds of box scenes that are hard for one algorithm or another are what they say.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <set>
#include <tuple>
#include <vector>

#include "bench/scenes/boxes.hpp"
#include "bench/scenes/surface.hpp"
#include "tests/broad_phase/oracle.hpp"

using namespace clinch;
using scenes::make_boxes;

namespace {

double side(const Aabb& box, int axis) {
    return double{box.max[axis]} - double{box.min[axis]};
}
double pairs_of(const std::vector<Aabb>& boxes) {
    return static_cast<double>(test::pairs_by_sweep(boxes).size());
}

}  // namespace

TEST_CASE("surface: two closed surfaces of triangles that cut each other", "[host]") {
    const std::size_t n = 4801;
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        INFO("seed " << seed);
        const std::vector<Aabb> boxes = make_boxes("surface", n, seed);
        std::size_t across = 0;
        std::vector<int> others(n);
        for (const Pair& pair : test::pairs_by_sweep(boxes)) {
            across += pair.a <= n / 2 && pair.b > n / 2 ? 1 : 0;
            ++others[pair.a];
            ++others[pair.b];
        }
        CHECK(across > 20);
        CHECK(across < n / 4);
        CHECK(pairs_of(boxes) == Approx(5.8 * double{n}).epsilon(0.03));
        // Every triangle of a closed surface has three beside it.
        CHECK(*std::min_element(others.begin(), others.end()) >= 3);
        for (const Aabb& box : boxes)
            for (int axis = 0; axis < 3; ++axis) {
                REQUIRE(side(box, axis) >= 0.0);
                REQUIRE(side(box, axis) < 2.5);
            }
    }
}

TEST_CASE("surface: the triangles left out are few, and every number of them works", "[host]") {
    for (const std::uint64_t triangles : {1u, 2u, 12u, 13u, 47u, 48u, 1000u}) {
        INFO(triangles);
        scenes::Random random(5);
        const scenes::BumpySurface surface(random, triangles, {10.0, 20.0, 30.0});
        const double reach = 1.2 * scenes::BumpySurface::radius(triangles);
        std::set<std::tuple<float, float, float, float, float, float>> different;
        for (std::uint64_t k = 0; k < triangles; ++k) {
            const Aabb box = surface.triangle_box(k);
            different.emplace(box.min[0], box.min[1], box.min[2], box.max[0], box.max[1], box.max[2]);
            for (int axis = 0; axis < 3; ++axis) {
                REQUIRE(double{box.min[axis]} > 10.0 * (axis + 1) - reach);
                REQUIRE(double{box.max[axis]} < 10.0 * (axis + 1) + reach);
            }
        }
        // Only at m = 1 do the two triangles of a cell that lies flat have the same box.
        if (triangles > 12) CHECK(different.size() > triangles * 9 / 10);
    }
}

TEST_CASE("plane: all boxes stand on one floor", "[host]") {
    const std::size_t n = 5000;
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        const std::vector<Aabb> boxes = make_boxes("plane", n, seed);
        for (const Aabb& box : boxes) {
            REQUIRE(box.min[2] == 0.0f);
            REQUIRE(side(box, 2) > 0.4999);
            REQUIRE(side(box, 2) < 1.5001);
            REQUIRE(side(box, 0) == Approx(side(box, 2)).margin(1e-4));
        }
        CHECK(pairs_of(boxes) == Approx(2.0 * double{n}).epsilon(0.06));
    }
}

TEST_CASE("line: needles in every direction", "[host]") {
    const std::size_t n = 5000;
    const std::vector<Aabb> boxes = make_boxes("line", n, 4);
    double means[3] = {0.0, 0.0, 0.0};
    for (const Aabb& box : boxes) {
        double square = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
            means[axis] += side(box, axis) / double{n};
            square += side(box, axis) * side(box, axis);
        }
        // The diagonal of the box is the needle's, but for its thickness.
        REQUIRE(std::sqrt(square) == Approx(10.0).epsilon(0.01));
    }
    for (const double mean : means) CHECK(mean == Approx(5.0).epsilon(0.05));
    CHECK(pairs_of(boxes) == Approx(4.0 * double{n}).epsilon(0.2));
}

TEST_CASE("identical: all boxes are one", "[host]") {
    const std::vector<Aabb> boxes = make_boxes("identical", 200, 3);
    for (const Aabb& box : boxes) REQUIRE(std::memcmp(&box, boxes.data(), sizeof(Aabb)) == 0);
    CHECK(pairs_of(boxes) == 19900.0);
    std::vector<const char*> all_pairs;
    for (const scenes::BoxKind& kind : scenes::box_kinds())
        if (kind.all_pairs) all_pairs.push_back(kind.name);
    REQUIRE(all_pairs.size() == 1);
    CHECK(std::string(all_pairs[0]) == "identical");
}

TEST_CASE("grid-touch: faces, edges and corners touch exactly", "[host]") {
    for (const std::size_t edge : {1u, 2u, 9u}) {
        const std::size_t n = edge * edge * edge;
        const std::vector<Aabb> boxes = make_boxes("grid-touch", n, 11);
        // Neighbours along d axes at once: 3 directions of one axis, 6 of two, 4 of three.
        const std::size_t less = edge - 1;
        const std::size_t expected = 3 * less * edge * edge + 6 * less * less * edge + 4 * less * less * less;
        CHECK(pairs_of(boxes) == static_cast<double>(expected));
        for (const Aabb& box : boxes)
            for (int axis = 0; axis < 3; ++axis) {
                REQUIRE(side(box, axis) == 1.0);
                REQUIRE(box.min[axis] == std::floor(box.min[axis]));
            }
    }
    const std::vector<Aabb> boxes = make_boxes("grid-touch", 5000, 11);  // a cube not quite full
    std::set<std::tuple<float, float, float>> places;
    for (const Aabb& box : boxes) places.emplace(box.min[0], box.min[1], box.min[2]);
    CHECK(places.size() == boxes.size());
    CHECK(pairs_of(boxes) == Approx(13.0 * 5000).epsilon(0.2));
}

TEST_CASE("far: density, far out", "[host]") {
    const std::size_t n = 3000;
    const std::vector<Aabb> near = make_boxes("density", n, 8);
    const auto offset_is = [&](const char* kind, double far, double spacing) {
        const std::vector<Aabb> boxes = make_boxes(kind, n, 8);
        for (std::size_t i = 0; i < n; ++i)
            for (int axis = 0; axis < 3; ++axis) {
                const double offset = axis == 1 ? -far : far;
                REQUIRE(double{boxes[i].min[axis]} == Approx(double{near[i].min[axis]} + offset).margin(spacing));
                REQUIRE(double{boxes[i].max[axis]} == Approx(double{near[i].max[axis]} + offset).margin(spacing));
            }
        return pairs_of(boxes);
    };
    CHECK(offset_is("far6", 1e6, 0.04) == Approx(pairs_of(near)).epsilon(0.1));
    // Boxes whose corners are whole numbers touch more often.
    CHECK(offset_is("far", 1e7, 0.51) > 1.5 * pairs_of(near));
}
