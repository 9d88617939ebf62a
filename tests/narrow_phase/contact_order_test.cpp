// Contacts found in any order, put in that of their pairs, against std::stable_sort.
#include "src/narrow_phase/contact_order.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <tuple>
#include <vector>

#include "tests/narrow_phase/narrow_scenes.hpp"
#include "tests/random.hpp"

using namespace clinch;
using detail::ContactOrder;

namespace {

// Rows of pairs in any order, those of a pair one after the other; `floor`: every second pair is one of body 0.
std::vector<Contact> random_rows(std::size_t pairs, std::uint32_t bodies, bool floor, test::Random& random) {
    std::vector<Contact> rows;
    for (std::size_t i = 0; i < pairs; ++i) {
        auto a = static_cast<std::uint32_t>(random.below(bodies)), b = static_cast<std::uint32_t>(random.below(bodies));
        if (floor && i % 2 == 0) a = 0;
        const auto points = static_cast<std::uint32_t>(1 + random.below(3));
        for (std::uint32_t k = 0; k < points; ++k) {
            Contact c{};
            std::tie(c.a, c.b) = std::minmax(a, b);
            c.feature = k;
            c.distance = random.between(-1, 1);
            rows.push_back(c);
        }
    }
    return rows;
}

}  // namespace

TEST_CASE("contacts are put in the order of their pairs", "[host]") {
    test::Random random(302);
    INFO("seed 302");
    ContactOrder order;  // keeps its memory
    for (const std::size_t pairs : {0u, 1u, 2u, 900u, 40000u, 3000u})
        for (const std::uint32_t bodies : {1u, 2u, 1000u, 70000u, 0xffffffffu})
            for (const bool floor : {false, true}) {
                INFO(pairs << " pairs of " << bodies << " bodies, with a floor: " << floor);
                const std::vector<Contact> rows = random_rows(pairs, bodies, floor, random);
                std::vector<std::uint64_t> keys(rows.size());
                std::transform(rows.begin(), rows.end(), keys.begin(), ContactOrder::key);
                std::vector<Contact> put(rows.size());
                order.put(rows, keys, bodies, put.data());
                std::vector<Contact> expected = rows;
                std::stable_sort(expected.begin(), expected.end(), [](const Contact& p, const Contact& q) {
                    return std::tie(p.a, p.b) < std::tie(q.a, q.b);
                });
                CHECK(test::same_bytes(put, expected));
            }
}
