#include "src/primitives/radix_sort.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>
#include <vector>

#include "tests/device/devices.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

// Sorts random keys of `bits` bits and compares with a stable sort; the payload is either numbered or given.
template <class Key>
void check_sort(detail::Device& device, detail::RadixSort& sort, std::uint32_t n, unsigned bits, bool number,
                test::Random& random) {
    INFO("n " << n << ", bits " << bits << ", numbered " << number);
    std::vector<Key> keys(n), sorted(n);
    std::vector<std::uint32_t> payload(n), moved(n);
    for (Key& key : keys) key = static_cast<Key>(random.bits() & ((bits == 64 ? 0 : std::uint64_t{1} << bits) - 1));
    std::iota(payload.begin(), payload.end(), number ? 0u : 1000u);
    std::vector<std::uint32_t> order(n);
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });

    detail::Buffer k = device.allocate(n * sizeof(Key), "keys"),
                   p = device.allocate(n * sizeof(std::uint32_t), "payload");
    device.write(k, keys.data(), n * sizeof(Key));
    if (!number) device.write(p, payload.data(), n * sizeof(std::uint32_t));
    sort.sort(k, p, n, bits, number);
    device.read(k, sorted.data(), n * sizeof(Key));
    device.read(p, moved.data(), n * sizeof(std::uint32_t));
    std::size_t wrong = 0;
    for (std::uint32_t i = 0; i < n; ++i)
        wrong += sorted[i] == keys[order[i]] && moved[i] == payload[order[i]] ? 0U : 1U;
    CHECK(wrong == 0);
}

void check_sizes(const std::vector<std::uint32_t>& sizes, const std::vector<std::uint32_t>& lanes, std::uint64_t seed) {
    INFO("seed " << seed);
    test::Random random(seed);
    for (std::uint32_t i = 0; i < list_devices().size(); ++i)
        for (const std::uint32_t lane_count : lanes) {  // one lane: many short runs, as on a GPU
            const Context context = test::with_lanes(i, lane_count);
            detail::Device& device = context.impl().open(0);
            detail::RadixSort sort32(device), sort64(device, detail::RadixSort::Key::Bits64);
            for (const std::uint32_t n : sizes)
                for (const bool number : {true, false}) {
                    check_sort<std::uint32_t>(device, sort32, n, 32, number, random);
                    check_sort<std::uint32_t>(device, sort32, n, 5, number, random);  // many equal keys
                    check_sort<std::uint64_t>(device, sort64, n, 64, number, random);
                    check_sort<std::uint64_t>(device, sort64, n, 41, number, random);
                }
        }
}

}  // namespace

TEST_CASE("radix sort of small arrays", "[device][small]") {
    check_sizes({1, 2, 300}, {1}, 51);
}

TEST_CASE("radix sort of large arrays", "[device]") {
    check_sizes({1, 255, 5000, 70001}, {1, 16}, 52);
}
