// Sorting on the host, against std::stable_sort.
#include "src/primitives/host_radix_sort.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

#include "tests/random.hpp"

using namespace clinch;

namespace {

struct Item {
    std::uint64_t key;
    std::size_t place;
    bool operator==(const Item& other) const { return key == other.key && place == other.place; }
};

std::vector<Item> sorted(std::vector<Item> items, unsigned bits) {
    std::vector<Item> spare(items.size());
    detail::host_radix_sort(items.data(), spare.data(), items.size(), bits, [](const Item& item) { return item.key; });
    return items;
}

}  // namespace

TEST_CASE("host radix sort is a stable sort", "[host]") {
    test::Random random(301);
    INFO("seed 301");
    for (const std::size_t count : {0u, 1u, 2u, 3u, 100u, 5000u})
        for (const unsigned bits : {1u, 7u, 8u, 11u, 12u, 22u, 23u, 29u, 32u, 33u, 48u, 63u, 64u})
            for (const bool few_keys : {false, true}) {
                std::vector<Item> items;
                const std::uint64_t mask = bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
                for (std::size_t i = 0; i < count; ++i) {
                    const std::uint64_t word = random.below(1u << 16) << 48 | random.below(1u << 16) << 32 |
                                               random.below(1u << 16) << 16 | random.below(1u << 16);
                    items.push_back({(few_keys ? word % 5 * (mask / 5) : word) & mask, i});
                }
                std::vector<Item> expected = items;
                std::stable_sort(expected.begin(), expected.end(),
                                 [](const Item& p, const Item& q) { return p.key < q.key; });
                INFO(count << " items, " << bits << " bits");
                CHECK((sorted(items, bits) == expected));
            }
}

TEST_CASE("host radix sort of no bits changes nothing", "[host]") {
    const std::vector<Item> items{{3, 0}, {1, 1}, {2, 2}};
    CHECK((sorted(items, 0) == items));
}
