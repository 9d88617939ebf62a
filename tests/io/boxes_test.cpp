// Boxes out of .npy files: rounding outward and rejected rows.
#include "tools/io/boxes.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "tests/io/npy_bytes.hpp"
#include "tests/io/temp_folder.hpp"

namespace {

using namespace clinch::test;
using clinch::Aabb;
using clinch::io::BoxFile;
using clinch::io::read_boxes;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

BoxFile read_doubles(const TempFolder& folder, const std::vector<double>& numbers) {
    const std::string shape = "(" + std::to_string(numbers.size() / 6) + ", 6)";
    return read_boxes(folder.write("d.npy", npy("<f8", shape, bytes(numbers))));
}

}  // namespace

TEST_CASE("float32 boxes are taken bit for bit in both orders", "[host]") {
    const TempFolder folder;
    const std::vector<float> rows{0, 1, 2, 3, 4, 5, -1.5f, -0.0f, 1e-42f, 1e30f, 0, 1};
    std::vector<float> columns;
    for (std::size_t c = 0; c < 6; ++c)
        for (std::size_t r = 0; r < 2; ++r) columns.push_back(rows[6 * r + c]);
    for (const bool fortran : {false, true}) {
        const BoxFile file =
            read_boxes(folder.write("f.npy", npy("<f4", "(2, 6)", bytes(fortran ? columns : rows), 1, fortran)));
        REQUIRE(file.boxes.size() == 2);
        CHECK(bytes(file.boxes) == bytes(rows));
        CHECK(file.rejected.empty());
    }
}

TEST_CASE("float64 boxes are rounded outward, and only where they must be", "[host]") {
    const std::uint64_t seed = 20111;
    INFO("seed " << seed);
    std::mt19937_64 random(seed);
    std::size_t exact = 0, rounded = 0;
    for (int i = 0; i < 20000; ++i) {
        std::array<double, 6> v{};
        for (std::size_t k = 0; k < 6; ++k) {
            const double unit = static_cast<double>(random() >> 11) * 0x1p-53;
            v[k] = (2.0 * unit - 1.0) * std::ldexp(1.0, static_cast<int>(random() % 270) - 150);
            if (random() % 4 == 0) v[k] = double{static_cast<float>(v[k])};
        }
        const Aabb box = clinch::io::round_outward(v);
        for (std::size_t k = 0; k < 6; ++k) {
            const bool low = k < 3;
            const float got = low ? box.min[k] : box.max[k - 3];
            const float inward = std::nextafter(
                got, low ? std::numeric_limits<float>::infinity() : -std::numeric_limits<float>::infinity());
            if (double{got} == v[k]) {
                ++exact;
                continue;
            }
            ++rounded;
            // Outside of the number, with no float between.
            REQUIRE((low ? double{got} < v[k] : double{got} > v[k]));
            REQUIRE((low ? double{inward} > v[k] : double{inward} < v[k]));
        }
    }
    CHECK(exact > 10000);
    CHECK(rounded > 10000);
}

TEST_CASE("rows that are no boxes are rejected with their reason", "[host]") {
    const TempFolder folder;
    const std::vector<double> good{0, 0, 0, 1, 1, 1};
    const struct {
        std::size_t at;
        double value;
        const char* why;
    } faults[] = {
        {0, not_a_number, "min x is nan and must be finite"},    {5, -not_a_number, "max z is nan and must be finite"},
        {4, infinity, "max y is inf and must be finite"},        {2, -infinity, "min z is -inf and must be finite"},
        {1, 2.0, "min y is 2 and must be <= max y, which is 1"},
    };
    std::vector<double> numbers = good;
    for (const auto& fault : faults) {
        numbers.insert(numbers.end(), good.begin(), good.end());
        numbers[numbers.size() - 6 + fault.at] = fault.value;
    }
    const std::string shape = "(6, 6)";
    const std::vector<float> singles(numbers.begin(), numbers.end());
    for (const bool doubles : {false, true}) {
        const BoxFile file = read_boxes(
            folder.write("x.npy", doubles ? npy("<f8", shape, bytes(numbers)) : npy("<f4", shape, bytes(singles))));
        INFO("float64 " << doubles);
        REQUIRE(file.boxes.size() == 6);
        REQUIRE(file.rejected.size() == 5);
        for (std::uint32_t i = 0; i < 5; ++i) {
            CHECK(file.rejected[i].body == i + 1);
            CHECK(file.rejected[i].why == faults[i].why);
        }
        for (std::size_t i = 0; i < 6; ++i) CHECK(clinch::overlap(file.boxes[i], file.boxes[i]) == (i == 0));
    }
}

TEST_CASE("float64 rows are judged before they are rounded", "[host]") {
    const TempFolder folder;
    const BoxFile file =
        read_doubles(folder, {1.0 + 1e-12, 0,   0,   1,      1,   1,  // min > max by less than a float sees
                              1e39,        0,   0,   1e39,   1,   1,  // beyond float32
                              0,           0,   0,   3.5e38, 1,   1,  // beyond float32
                              0,           0,   0,   0,      0,   0,  // a point is a box
                              0.1,         0.1, 0.1, 0.1,    0.1, 0.1, -3.4028234e38, 0, 0, 3.4028234e38, 1, 1});
    REQUIRE(file.rejected.size() == 3);
    CHECK_THAT(file.rejected[0].why, Catch::Contains("min x is 1.000000000001 and must be <= max x"));
    CHECK_THAT(file.rejected[1].why, Catch::Contains("min x is 1e+39") && Catch::Contains("float32's range"));
    CHECK_THAT(file.rejected[2].why, Catch::Contains("max x is 3.5e+38"));
    CHECK(std::isnan(file.boxes[0].min[0]));
    CHECK(file.boxes[3].min[0] == 0.0f);
    CHECK(file.boxes[3].max[0] == 0.0f);
    CHECK(double{file.boxes[4].min[0]} < 0.1);
    CHECK(double{file.boxes[4].max[0]} > 0.1);
    CHECK(std::isfinite(file.boxes[5].min[0]));
}
