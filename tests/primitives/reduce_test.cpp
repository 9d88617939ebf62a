#include "src/primitives/reduce.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "tests/device/devices.hpp"
#include "tests/random.hpp"

using namespace clinch;
using detail::Reduce;

namespace {

template <class T>
void reduce(detail::Device& device, Reduce& reduction, const std::vector<T>& values) {
    const detail::Buffer buffer = device.allocate(values.size() * sizeof(T), "values");
    device.write(buffer, values.data(), values.size() * sizeof(T));
    reduction.run(buffer, static_cast<std::uint32_t>(values.size()));
}

// The three operations of one device.
struct Operations {
    Reduce sum, least, largest;
    Operations(detail::Device& device, Reduce::Value value)
        : sum(device, Reduce::Operation::Sum, value),
          least(device, Reduce::Operation::Least, value),
          largest(device, Reduce::Operation::Largest, value) {}
};

void check_uints(detail::Device& device, Operations& on, std::size_t n, test::Random& random) {
    std::vector<std::uint32_t> values(n);
    for (std::uint32_t& value : values) value = static_cast<std::uint32_t>(random.bits());
    reduce(device, on.sum, values);
    CHECK(on.sum.as_uint() == std::accumulate(values.begin(), values.end(), 0u));
    reduce(device, on.least, values);
    CHECK(on.least.as_uint() == (n == 0 ? ~0u : *std::min_element(values.begin(), values.end())));
    reduce(device, on.largest, values);
    CHECK(on.largest.as_uint() == (n == 0 ? 0u : *std::max_element(values.begin(), values.end())));
}

void check_floats(detail::Device& device, Operations& on, std::size_t n, test::Random& random) {
    constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<float> values(n);
    for (float& value : values) value = static_cast<float>(random.below(2001)) - 1000.0f;  // their sums are exact
    reduce(device, on.sum, values);
    CHECK(on.sum.as_float() == std::accumulate(values.begin(), values.end(), 0.0f));
    const float least = n == 0 ? inf : *std::min_element(values.begin(), values.end()),
                largest = n == 0 ? -inf : *std::max_element(values.begin(), values.end());
    values.push_back(nan);
    reduce(device, on.least, values);
    CHECK(on.least.as_float() == least);
    reduce(device, on.largest, values);
    CHECK(on.largest.as_float() == largest);
}

void check_sizes(const std::vector<std::size_t>& sizes, const std::vector<std::uint32_t>& lanes, std::uint64_t seed) {
    INFO("seed " << seed);
    test::Random random(seed);
    for (std::uint32_t i = 0; i < list_devices().size(); ++i)
        for (const std::uint32_t lane_count : lanes) {
            const Context context = test::with_lanes(i, lane_count);
            detail::Device& device = context.impl().open(0);
            Operations uints(device, Reduce::Value::Uint), floats(device, Reduce::Value::Float);
            for (const std::size_t n : sizes) {
                INFO("n " << n << ", lanes " << lane_count);
                check_uints(device, uints, n, random);
                check_floats(device, floats, n, random);
            }
        }
}

}  // namespace

TEST_CASE("reduction of few values", "[device][small]") {
    check_sizes({0, 1, 2, 255, 256, 257, 600}, {1}, 61);
}

TEST_CASE("reduction of few values, in vectors", "[device][vectors]") {
    check_sizes({0, 1, 15, 16, 17, 600}, {4, 16}, 62);
}

TEST_CASE("reduction of many values", "[device]") {
    check_sizes({5000, 12289, 0, 3}, {1, 4, 8, 16}, 63);
}

TEST_CASE("reduction of more values than some devices' loops have turns", "[device]") {
    test::Random random(64);
    for (std::uint32_t i = 0; i < list_devices().size(); ++i)
        for (const std::uint32_t lane_count : {1u, 16u}) {
            const Context context = test::with_lanes(i, lane_count);
            detail::Device& device = context.impl().open(0);
            Operations uints(device, Reduce::Value::Uint);
            check_uints(device, uints, 1500007, random);
        }
}
