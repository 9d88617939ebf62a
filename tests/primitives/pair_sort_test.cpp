#include "src/primitives/pair_sort.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <vector>

#include "clinch/aabb.hpp"
#include "tests/device/devices.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

void check_sort(detail::Device& device, detail::PairSort& sort, std::vector<Pair> pairs, std::uint32_t bodies) {
    INFO("pairs " << pairs.size() << ", bodies " << bodies);
    detail::Buffer buffer = device.allocate(pairs.size() * sizeof(Pair), "pairs");
    device.write(buffer, pairs.data(), pairs.size() * sizeof(Pair));
    sort.sort(buffer, pairs.size(), bodies);
    std::vector<Pair> found(pairs.size());
    device.read(buffer, found.data(), found.size() * sizeof(Pair));
    std::sort(pairs.begin(), pairs.end());
    CHECK(found == pairs);
}

void check_sizes(const std::vector<std::size_t>& sizes, std::uint64_t seed) {
    INFO("seed " << seed);
    test::Random random(seed);
    const Context context = test::all_devices();
    for (std::size_t i = 0; i < context.devices().size(); ++i) {
        detail::Device& device = context.impl().open(i);
        detail::PairSort sort(device);
        for (const std::size_t n : sizes)
            for (const std::uint32_t bodies : {2u, 200u, 257u, 100000u, 4294967295u}) {
                std::vector<Pair> spread(n), skewed(n);
                for (std::size_t k = 0; k < n; ++k) {
                    spread[k] = {static_cast<std::uint32_t>(random.below(bodies)),
                                 static_cast<std::uint32_t>(random.below(bodies))};
                    skewed[k] = {bodies / 2, static_cast<std::uint32_t>(random.below(bodies))};  // all in one bucket
                }
                check_sort(device, sort, spread, bodies);
                check_sort(device, sort, skewed, bodies);
                std::sort(spread.begin(), spread.end(), [](const Pair& p, const Pair& q) { return q < p; });
                check_sort(device, sort, spread, bodies);  // in reverse
            }
    }
}

}  // namespace

TEST_CASE("sort of few pairs", "[device][small]") {
    check_sizes({0, 1, 2, 47, 48, 49, 300}, 53);
}

TEST_CASE("sort of many pairs", "[device]") {
    check_sizes({5000, 300001}, 54);
}
