// Where the rows of chunks belong, told in any order and by several threads.
#include "src/narrow_phase/contact_places.hpp"

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <cstdint>
#include <numeric>
#include <optional>
#include <thread>
#include <vector>

#include "src/narrow_phase/row_list.hpp"
#include "tests/random.hpp"

using namespace clinch;
using detail::ContactPlaces;
using detail::RowList;

TEST_CASE("a chunk's place is known as soon as all chunks before it are", "[host]") {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        INFO("seed " << seed);
        test::Random random(seed);
        const auto chunks = static_cast<std::uint32_t>(1 + random.below(30));
        std::vector<std::uint32_t> order(chunks);
        std::iota(order.begin(), order.end(), 0u);
        for (std::size_t i = chunks - 1; i > 0; --i) std::swap(order[i], order[random.below(i + 1)]);
        std::vector<std::size_t> rows(chunks);
        for (std::size_t& count : rows) count = random.below(4) * random.below(1000);
        std::vector<bool> told(chunks, false);
        ContactPlaces places(chunks);
        CHECK(places.expected() == 0);
        std::size_t total = 0;
        for (const std::uint32_t chunk : order) {
            places.tell(chunk, rows[chunk]);
            told[chunk] = true;
            total += rows[chunk];
            CHECK(places.told() == total);
            CHECK(places.expected() >= total);
            std::size_t first = 0;
            bool known = true;
            for (std::uint32_t c = 0; c < chunks; ++c) {
                CHECK(places.first_of(c) == (known ? std::optional<std::size_t>(first) : std::nullopt));
                known = known && told[c];
                first += rows[c];
            }
        }
    }
}

TEST_CASE("rows are written by several threads while the list grows", "[host]") {
    constexpr std::uint32_t chunks = 400, threads = 4;
    const auto rows_of = [](std::uint32_t chunk) { return std::size_t{chunk % 7} * 100; };
    std::vector<std::size_t> firsts(chunks + 1, 0);
    for (std::uint32_t c = 0; c < chunks; ++c) firsts[c + 1] = firsts[c] + rows_of(c);
    for (const std::size_t expected : {std::size_t{0}, firsts[chunks] / 2, 100 * firsts[chunks]}) {
        RowList<std::uint64_t> list;
        std::atomic<std::uint32_t> next{0};
        std::vector<std::thread> crew;
        for (std::uint32_t t = 0; t < threads; ++t)
            crew.emplace_back([&] {
                for (std::uint32_t c = next++; c < chunks; c = next++)
                    list.write_at(firsts[c], rows_of(c), expected, [&](std::uint64_t* to) {
                        for (std::size_t i = 0; i < rows_of(c); ++i) to[i] = firsts[c] + i;
                    });
            });
        for (std::thread& thread : crew) thread.join();
        list.resize(firsts[chunks]);
        REQUIRE(list.size() == firsts[chunks]);
        const auto view = list.view();
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < view.size(); ++i) wrong += view[i] == i ? 0U : 1U;
        CHECK(wrong == 0);
    }
}
