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

// The same into keys of a layout made for another number of pairs.
void check_keys(detail::Device& device, detail::PairSort& sort, std::vector<Pair> pairs, std::size_t guess,
                std::uint32_t bodies) {
    const auto layout = detail::PairSort::layout_for(guess, bodies, device.info());
    if (!layout) return;
    INFO("keys of " << pairs.size() << " pairs, guessed " << guess << ", bodies " << bodies << ", lanes "
                    << device.info().lanes);
    REQUIRE(layout->shift + layout->b_bits <= 32);
    detail::Buffer buffer = device.allocate(pairs.size() * sizeof(Pair), "pairs");
    if (!pairs.empty()) device.write(buffer, pairs.data(), pairs.size() * sizeof(Pair));
    const detail::PairSort::Packed packed = sort.sort_to_keys(buffer, pairs.size(), *layout);
    std::sort(pairs.begin(), pairs.end());
    REQUIRE(packed.starts.size() == layout->buckets + std::size_t{1});
    CHECK(packed.starts.front() == 0);
    CHECK(packed.starts.back() == pairs.size());
    std::vector<Pair> found(pairs.size()), past_caches(pairs.size());
    for (std::uint32_t bucket = 0; bucket < layout->buckets; ++bucket) {
        const std::uint32_t start = packed.starts[bucket];
        REQUIRE(packed.starts[bucket + 1] >= start);
        const std::uint32_t count = packed.starts[bucket + 1] - start;
        if (count == 0) continue;
        const std::uint32_t* const keys = packed.keys.as<std::uint32_t>() + start;
        detail::KeyUnpacker<false>(bucket, *layout).all(keys, count, found.data() + start);
        detail::KeyUnpacker<true>(bucket, *layout).all(keys, count, past_caches.data() + start);
    }
    detail::end_past_caches();
    CHECK(found == pairs);
    CHECK(past_caches == pairs);
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
            const bool packs = detail::PairSort::packs_on(device.info());
            CHECK(packs == (lane_count > 1 && device.info().quirks.empty()));
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
                    if (packs) {
                        check_keys(device, sort, spread, n, bodies);
                        check_keys(device, sort, spread, random.below(10000000), bodies);
                        check_keys(device, sort, skewed, random.below(100000), bodies);
                    }
                    std::sort(spread.begin(), spread.end(), [](const Pair& p, const Pair& q) { return q < p; });
                    check_sort(device, sort, spread, bodies);  // in reverse
                }
        }
}

}  // namespace

TEST_CASE("sort of few pairs", "[device][small]") {
    check_sizes({0, 1, 4, 5, 35, 36, 300, 1100}, {1, 8}, 53);
}

TEST_CASE("keys of pairs fit in 32 bits or are none", "[host]") {
    DeviceInfo info;
    info.lanes = 16;
    info.compute_units = 2;
    for (const std::uint64_t pairs : {0u, 1u, 5000u, 1000000u, 4000000000u})
        for (std::uint32_t bits = 0; bits < 33; ++bits)
            for (const int more : {-1, 0, 1}) {
                const std::uint64_t bodies = (std::uint64_t{1} << bits) + static_cast<std::uint64_t>(more);
                if (bodies == 0 || bodies > 0xffffffffu) continue;
                INFO(pairs << " pairs of " << bodies << " bodies");
                const auto layout = detail::PairSort::layout_for(pairs, static_cast<std::uint32_t>(bodies), info);
                if (bodies > std::uint64_t{1} << 22) CHECK_FALSE(layout);
                if (pairs >= 1000000 && bodies <= std::uint64_t{1} << 22) CHECK(layout);
                if (!layout) continue;
                CHECK(layout->shift + layout->b_bits <= 32);
                CHECK(bodies - 1 <= (std::uint64_t{1} << layout->b_bits) - 1);
                CHECK((bodies - 1) >> layout->shift == layout->buckets - 1);
                CHECK(layout->buckets <= 4096);
            }
}

TEST_CASE("sort of many pairs", "[device]") {
    check_sizes({5000, 300001}, {1, 4, 16}, 54);
}
