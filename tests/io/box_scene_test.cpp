// Rows of box files as bodies: the boxes of the file, or how far from them.
#include "tools/io/box_scene.hpp"

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "tests/io/npy_bytes.hpp"
#include "tests/io/temp_folder.hpp"
#include "tests/random.hpp"
#include "tools/io/boxes.hpp"

namespace {

using namespace clinch::test;
using clinch::Box;
using clinch::Vec3;
using clinch::io::LoadedScene;
using Wide = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<400>>;

template <class Number>
LoadedScene read(const TempFolder& folder, const std::vector<Number>& numbers) {
    const std::string shape = "(" + std::to_string(numbers.size() / 6) + ", 6)";
    return clinch::io::read_box_scene(
        folder.write("b.npy", npy(sizeof(Number) == 4 ? "<f4" : "<f8", shape, bytes(numbers))));
}

Vec3 half_of(const LoadedScene& loaded, std::uint32_t row) {
    return std::get<Box>(loaded.scene.shape(loaded.scene.body({row}).shape)).half_extents;
}

/// How far the corner of the body that is farthest from its place in the file is from there.
double corner_off(const LoadedScene& loaded, std::uint32_t row, const double* min_max) {
    const Vec3 middle = loaded.scene.body({row}).pose.position, half = half_of(loaded, row);
    Wide square = 0;
    const double c[3] = {middle.x, middle.y, middle.z}, h[3] = {half.x, half.y, half.z};
    for (int d = 0; d < 3; ++d) {
        const Wide low = abs(Wide(c[d]) - Wide(h[d]) - Wide(min_max[d]));
        const Wide high = abs(Wide(c[d]) + Wide(h[d]) - Wide(min_max[d + 3]));
        square += low > high ? low * low : high * high;
    }
    const Wide off = sqrt(square);
    const double rounded = static_cast<double>(off);
    return Wide(rounded) < off ? std::nextafter(rounded, std::numeric_limits<double>::max()) : rounded;
}

}  // namespace

TEST_CASE("float32 boxes become bodies that are those boxes exactly", "[host]") {
    const std::uint64_t seed = 5;
    INFO("seed " << seed);
    Random random(seed);
    const TempFolder folder;
    std::vector<float> numbers;
    for (int i = 0; i < 2000; ++i) {
        const double at = random.between(-50, 50);
        float low[3], high[3];
        for (int d = 0; d < 3; ++d) {
            low[d] = static_cast<float>(at + random.between(-1, 1));
            high[d] = low[d] + static_cast<float>(random.between(0.01, 2));
        }
        numbers.insert(numbers.end(), low, low + 3);
        numbers.insert(numbers.end(), high, high + 3);
    }
    const LoadedScene loaded = read(folder, numbers);
    REQUIRE(loaded.scene.row_count() == 2000);
    CHECK(loaded.names.size() == 2000);
    CHECK(loaded.slack.empty());
    CHECK(loaded.reasons.empty());
    CHECK(loaded.scene.rejected().empty());
    const std::vector<double> wide(numbers.begin(), numbers.end());
    for (std::uint32_t i = 0; i < 2000; ++i) {
        REQUIRE(corner_off(loaded, i, &wide[std::size_t{6} * i]) == 0.0);
        REQUIRE(loaded.scene.body({i}).margin == 0.0);
    }
}

TEST_CASE("float64 boxes are at most their slack away, and margins cover what rounding takes", "[host]") {
    const std::uint64_t seed = 6;
    INFO("seed " << seed);
    Random random(seed);
    const TempFolder folder;
    std::vector<double> numbers;
    constexpr std::uint32_t count = 3000;
    for (std::uint32_t i = 0; i < count; ++i) {
        // Far away and small, near and large, and down to the smallest numbers there are.
        const double far = i % 3 == 0 ? 1e6 : 1.0, size = i % 5 == 0 ? 1e-9 : 1.0;
        double low[3], high[3];
        for (int d = 0; d < 3; ++d) {
            low[d] = random.between(-far, far);
            high[d] = low[d] + random.between(0.0, size);
            if (i % 7 == 0) {
                low[d] = -5e-324 * static_cast<double>(random.below(4));
                high[d] = 5e-324 * static_cast<double>(1 + random.below(4));
            }
        }
        numbers.insert(numbers.end(), low, low + 3);
        numbers.insert(numbers.end(), high, high + 3);
    }
    const LoadedScene loaded = read(folder, numbers);
    REQUIRE(loaded.scene.row_count() == count);
    REQUIRE(loaded.scene.rejected().empty());
    std::size_t uncovered = 0, loose = 0, rounded = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const double slack = i < loaded.slack.size() ? loaded.slack[i] : 0.0;
        const double off = corner_off(loaded, i, &numbers[std::size_t{6} * i]), margin = loaded.scene.body({i}).margin;
        double largest = 0.0;
        for (std::size_t k = 0; k < 6; ++k) largest = std::max(largest, std::fabs(numbers[std::size_t{6} * i + k]));
        const bool thickened = slack != margin;
        if (off > slack || (!thickened && off > margin)) ++uncovered;
        if (slack > 4.0 * 0x1p-52 * largest && !(i % 7 == 0)) ++loose;
        if (off > 0.0) ++rounded;
    }
    CHECK(uncovered == 0);
    CHECK(loose == 0);
    CHECK(rounded > count / 3);
}

TEST_CASE("boxes of zero width are given a little, and say so", "[host]") {
    const TempFolder folder;
    // A face, a segment, a point, the point at the origin, and a box.
    const std::vector<double> numbers{1, 2, 3, 3, 4, 3, 1, 2, 3, 9, 2, 3, 0, 0, 8,
                                      0, 0, 8, 0, 0, 0, 0, 0, 0, 1, 1, 1, 2, 2, 2};
    const LoadedScene loaded = read(folder, numbers);
    REQUIRE(loaded.scene.row_count() == 5);
    CHECK(loaded.scene.rejected().empty());
    REQUIRE(loaded.slack.size() == 5);
    const double thin[] = {0x1p-60, 0x1p-58, 0x1p-57, 0x1p-100};
    const double axes[] = {1, 2, 3, 3};
    for (std::uint32_t i = 0; i < 4; ++i) {
        INFO(i);
        CHECK(half_of(loaded, i).z == thin[i]);
        CHECK(loaded.scene.body({i}).margin == 0.0);
        CHECK(loaded.slack[i] >= corner_off(loaded, i, &numbers[std::size_t{6} * i]));
        CHECK(loaded.slack[i] <= 1.01 * axes[i] * thin[i]);
    }
    CHECK(half_of(loaded, 0).x == 1.0);
    CHECK(half_of(loaded, 1).x == 4.0);
    CHECK(loaded.slack[4] == 0.0);
}

TEST_CASE("rows that are no boxes are rejected bodies, for the reasons of read_boxes", "[host]") {
    const TempFolder folder;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<double> numbers{0, 0,   0, 1, 1, 1, 0, nan, 0, 1, 1, 1, 0, 0, 2,     1, 1, 1,
                                      0, 0.1, 0, 1, 1, 1, 0, 0,   0, 1, 1, 1, 0, 0, -1e39, 1, 1, 1};
    const LoadedScene loaded = read(folder, numbers);
    const auto expected = clinch::io::read_boxes(folder / "b.npy").rejected;
    REQUIRE(expected.size() == 3);
    const auto found = clinch::io::merge_rejections(loaded.scene.rejected(), loaded.reasons);
    REQUIRE(found.size() == expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        CHECK(found[i].body == expected[i].body);
        CHECK(found[i].why == expected[i].why);
    }
}
