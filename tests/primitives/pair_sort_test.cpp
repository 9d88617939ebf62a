#include "src/primitives/pair_sort.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <vector>

#include "clinch/aabb.hpp"
#include "tests/device/devices.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

// Sorts all pairs but the last few, which must stay.
void check_sort(detail::Device& device, detail::PairSort& sort, std::vector<Pair> pairs, std::uint32_t bodies) {
    const std::size_t count = pairs.size() - std::min<std::size_t>(pairs.size(), 3);
    INFO("pairs " << count << ", bodies " << bodies << ", lanes " << device.info().lanes);
    detail::Buffer buffer = device.allocate(pairs.size() * sizeof(Pair), "pairs");
    device.write(buffer, pairs.data(), pairs.size() * sizeof(Pair));
    sort.sort(buffer, count, bodies);
    std::vector<Pair> found(pairs.size());
    device.read(buffer, found.data(), found.size() * sizeof(Pair));
    std::sort(pairs.begin(), pairs.begin() + static_cast<std::ptrdiff_t>(count));
    CHECK(std::equal(found.begin(), found.end(), pairs.begin(), pairs.end()));
}

// `bodies` about where keys no longer fit in 32 bits (2^20 with one lane, 2^22 with more), and at the ends.
void check_sizes(const std::vector<std::size_t>& sizes, const std::vector<std::uint32_t>& lanes, std::uint64_t seed) {
    INFO("seed " << seed);
    test::Random random(seed);
    for (std::uint32_t i = 0; i < list_devices().size(); ++i)
        for (const std::uint32_t lane_count : lanes) {
            const Context context = test::with_lanes(i, lane_count);
            detail::Device& device = context.impl().open(0);
            detail::PairSort sort(device);
            for (const std::size_t n : sizes)
                for (const std::uint32_t bodies :
                     {2u, 200u, 257u, 100000u, 1048576u, 1048577u, 4194304u, 4194305u, 4294967295u}) {
                    std::vector<Pair> spread(n), skewed(n);
                    for (std::size_t k = 0; k < n; ++k) {
                        spread[k] = {static_cast<std::uint32_t>(random.below(bodies)),
                                     static_cast<std::uint32_t>(random.below(bodies))};
                        skewed[k] = {bodies / 2,
                                     static_cast<std::uint32_t>(random.below(bodies))};  // all in one bucket
                    }
                    if (n > 4) spread[n - 4] = {bodies - 1, bodies - 1};  // the greatest key, among those to be sorted
                    check_sort(device, sort, spread, bodies);
                    check_sort(device, sort, skewed, bodies);
                    std::sort(spread.begin(), spread.end(), [](const Pair& p, const Pair& q) { return q < p; });
                    check_sort(device, sort, spread, bodies);  // in reverse
                }
        }
}

}  // namespace

TEST_CASE("sort of few pairs", "[device][small]") {
    check_sizes({0, 1, 4, 5, 35, 36, 300, 1100}, {1, 8}, 53);
}

TEST_CASE("sort of many pairs", "[device]") {
    check_sizes({5000, 300001}, {1, 4, 16}, 54);
}
