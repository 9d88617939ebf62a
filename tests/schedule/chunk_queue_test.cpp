#include "src/schedule/chunk_queue.hpp"

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <cstdint>
#include <limits>
#include <optional>
#include <thread>
#include <vector>

#include "clinch/error.hpp"
#include "tests/random.hpp"
#include "tests/watchdog.hpp"

using namespace clinch;
using detail::ChunkQueue;

namespace {

using Chunks = std::vector<std::uint32_t>;

Chunks take(ChunkQueue& queue, std::size_t taker, std::size_t most) {
    Chunks found;
    while (found.size() < most) {
        const std::optional<std::uint32_t> chunk = queue.take(taker);
        if (!chunk) break;
        found.push_back(*chunk);
    }
    return found;
}

constexpr std::size_t all = std::numeric_limits<std::size_t>::max();

}  // namespace

TEST_CASE("chunks are dealt by share, in the order of finishing", "[host][schedule]") {
    ChunkQueue equal(6, {{1.0}, {1.0}});
    CHECK(take(equal, 1, 3) == Chunks{1, 3, 5});
    CHECK(take(equal, 0, 3) == Chunks{0, 2, 4});
    CHECK(equal.left() == 0);

    // 1 : 3. The fast one finishes chunks at 4/3, 8/3, 4 (a tie, which the first taker wins), 16/3, ...
    ChunkQueue unlike(8, {{0.25}, {0.75}});
    CHECK(take(unlike, 0, 2) == Chunks{2, 6});
    CHECK(take(unlike, 1, 6) == Chunks{0, 1, 3, 4, 5, 7});
    CHECK(unlike.stolen(0) + unlike.stolen(1) == 0);
}

TEST_CASE("the amounts dealt are the shares to within one chunk", "[host][schedule]") {
    const std::uint64_t seed = 501;
    INFO("seed " << seed);
    test::Random random(seed);
    for (int round = 0; round < 200; ++round) {
        const auto n = static_cast<std::uint32_t>(random.below(300));
        std::vector<ChunkQueue::Taker> takers(1 + random.below(9));
        double sum = 0.0;
        for (ChunkQueue::Taker& taker : takers) {
            taker.fraction = random.below(4) == 0 ? 0.0 : random.between(0.1, 8.0);
            taker.seconds_a_chunk = 1.0;
            taker.seconds_to_begin = 1e9;  // nobody steals: it shows what was dealt
            sum += taker.fraction;
        }
        if (sum <= 0.0) continue;
        ChunkQueue queue(n, takers);
        Chunks taken;
        // Who was dealt something first: the others would find victims that have not begun and never will.
        for (std::size_t i = 0; i < takers.size(); ++i) {
            const double exact = static_cast<double>(n) * takers[i].fraction / sum + 1e-9;
            const Chunks own = take(queue, i, static_cast<std::size_t>(exact));
            CHECK(std::is_sorted(own.begin(), own.end()));
            CHECK(queue.stolen(i) == 0);
            taken.insert(taken.end(), own.begin(), own.end());
        }
        CHECK(queue.left() < takers.size());
        CHECK(queue.left() + taken.size() == n);
        std::sort(taken.begin(), taken.end());
        CHECK(std::adjacent_find(taken.begin(), taken.end()) == taken.end());
    }
}

TEST_CASE("without fractions all takers get as much", "[host][schedule]") {
    ChunkQueue queue(4, {{0.0}, {0.0}});
    CHECK(take(queue, 0, 2) == Chunks{0, 2});
    CHECK(take(queue, 1, 2) == Chunks{1, 3});
}

TEST_CASE("an idle taker steals the upper half of the busiest", "[host][schedule]") {
    ChunkQueue queue(9, {{5.0}, {3.0}, {1.0}});
    const Chunks own = take(queue, 2, 1);
    REQUIRE(own.size() == 1);
    // By fractions all three are done at once; 0 then takes one of its 5, 1 all of its 3.
    const Chunks of_0 = take(queue, 0, 1), of_1 = take(queue, 1, 3);
    CHECK(of_0.size() + of_1.size() + own.size() + queue.left() == 9);
    const Chunks loot = take(queue, 2, 2);  // of the 4 that 0 has left
    const Chunks rest = take(queue, 0, 2);
    REQUIRE(loot.size() == 2);
    REQUIRE(rest.size() == 2);
    CHECK(std::is_sorted(loot.begin(), loot.end()));
    CHECK(rest.back() < loot.front());
    CHECK(queue.stolen(2) == 2);
    CHECK(queue.taken(2) == 3);
    CHECK(queue.left() == 0);
    CHECK_FALSE(queue.take(2));
}

TEST_CASE("the busiest is the one that needs most time, not most chunks", "[host][schedule]") {
    // Dealt 4, 4 and 0: the second needs ten times as long for its four.
    ChunkQueue queue(8, {{1.0, 1.0}, {1.0, 10.0}, {0.0, 1.0}});
    CHECK(take(queue, 2, 2) == Chunks{5, 7});
    CHECK(take(queue, 1, 2) == Chunks{1, 3});
}

TEST_CASE("stealing that does not pay is left", "[host][schedule]") {
    SECTION("a transfer longer than all that is left") {
        ChunkQueue queue(10, {{1.0, 0.1}, {0.0, 0.1, 2.0}});
        CHECK_FALSE(queue.take(1));
        CHECK(take(queue, 0, all).size() == 10);
    }
    SECTION("the transfer is paid once: who has begun steals") {
        ChunkQueue queue(20, {{0.9, 0.1}, {0.1, 0.1, 1.0}});
        CHECK(take(queue, 1, 2).size() == 2);
        CHECK(take(queue, 1, 9).size() == 9);  // 0.9 s; with 1 s to begin more than the 1.8 s of the other one alone
        CHECK(queue.stolen(1) == 9);
    }
    SECTION("a slow thief takes less than half, or none") {
        ChunkQueue some(16, {{1.0, 1.0}, {0.0, 4.0}});
        CHECK(some.take(1) == 12u);  // 8 chunks would take it 32 s, 4 take it 16 s as the other one all
        CHECK(take(some, 1, 3) == Chunks{13, 14, 15});
        ChunkQueue none(16, {{1.0, 1.0}, {0.0, 17.0}});
        CHECK_FALSE(none.take(1));
    }
    SECTION("without times half is stolen always") {
        ChunkQueue queue(8, {{1.0}, {0.0}});
        CHECK(take(queue, 1, 4) == Chunks{4, 5, 6, 7});
    }
    SECTION("chunks of one that was told nothing is left are anyone's") {
        ChunkQueue queue(4, {{1.0, 1.0}, {1.0, 1.0}, {0.0, 50.0}});
        CHECK_FALSE(queue.take(2));
        CHECK(take(queue, 0, 2).size() == 2);
        CHECK(take(queue, 1, 2).size() == 2);
        CHECK_FALSE(queue.take(0));
        CHECK_FALSE(queue.take(1));
        queue.retire(1, 3);
        CHECK(queue.take(2) == 3u);  // however slow: nobody else may come
    }
}

TEST_CASE("a failed taker's chunks go to the others, before their later ones", "[host][schedule]") {
    ChunkQueue queue(12, {{1.0}, {1.0}, {1.0}});
    CHECK(take(queue, 0, 1) == Chunks{0});
    CHECK(take(queue, 1, 1) == Chunks{1});
    CHECK(take(queue, 2, 1) == Chunks{2});
    queue.retire(1, 1);
    CHECK(queue.left() == 10);
    CHECK(queue.taken(1) == 0);
    CHECK_FALSE(queue.take(1));
    CHECK(take(queue, 0, 5) == Chunks{1, 3, 6, 7, 9});
    CHECK(take(queue, 2, 5) == Chunks{4, 5, 8, 10, 11});
    CHECK(queue.left() == 0);

    // The last but one fails when the last has nothing left and was told so.
    CHECK_FALSE(queue.take(0));
    queue.retire(2, 11);
    queue.retire(2, 10);  // two were in its hands
    CHECK(take(queue, 0, all) == Chunks{10, 11});

    queue.retire(0, 11);
    CHECK(queue.left() == 1);
    CHECK_FALSE(queue.take(0));
    CHECK(queue.taken(0) + queue.taken(1) + queue.taken(2) == 11);
}

TEST_CASE("wrong numbers of a chunk queue", "[host][schedule]") {
    CHECK_THROWS_AS(ChunkQueue(1, {{-1.0}}), Error);
    CHECK_THROWS_AS(ChunkQueue(1, {{std::numeric_limits<double>::quiet_NaN()}}), Error);
    CHECK_THROWS_AS(ChunkQueue(1, {{1.0, std::numeric_limits<double>::infinity()}}), Error);
    CHECK_THROWS_AS(ChunkQueue(1, {{1.0, 0.0, -1.0}}), Error);
    ChunkQueue queue(4, {{1.0}, {1.0}});
    CHECK_THROWS_AS(queue.retire(0, 0), Error);  // not taken yet
    CHECK(queue.take(0) == 0u);
    CHECK_THROWS_AS(queue.retire(1, 0), Error);
    CHECK_THROWS_AS(queue.retire(1, 4), Error);
    CHECK(queue.left() == 3);
    CHECK(ChunkQueue(5, {}).left() == 5);
    ChunkQueue empty(0, {{1.0}});
    CHECK_FALSE(empty.take(0));
}

namespace {

// Devices as threads: spin a little for each chunk, some fail with a chunk in hand. Returns how often each was done.
struct Run {
    std::vector<std::uint32_t> done;
    std::uint32_t left = 0, taken = 0;
};

Run run_threads(std::uint64_t seed) {
    test::Random random(seed);
    const auto n = static_cast<std::uint32_t>(random.below(400));
    std::vector<ChunkQueue::Taker> takers(2 + random.below(5));
    const bool measured = random.below(2) == 0;
    std::vector<std::uint64_t> fails_after;
    for (ChunkQueue::Taker& taker : takers) {
        taker.fraction = random.below(5) == 0 ? 0.0 : random.between(0.1, 4.0);
        if (measured) taker.seconds_a_chunk = random.between(0.1, 4.0);
        if (measured) taker.seconds_to_begin = random.below(3) == 0 ? random.between(0.0, 50.0) : 0.0;
        fails_after.push_back(random.below(3) == 0 ? random.below(60) : ~std::uint64_t{0});
    }
    fails_after[random.below(takers.size())] = ~std::uint64_t{0};  // one lives on
    ChunkQueue queue(n, takers);
    std::vector<std::atomic<std::uint32_t>> done(n);
    std::atomic<std::uint32_t> undone{n};
    const auto device = [&](std::size_t i, std::uint64_t own_seed) {
        test::Random own(own_seed);
        std::uint64_t count = 0;
        while (undone.load() > 0) {
            const std::optional<std::uint32_t> chunk = queue.take(i);
            if (!chunk) {
                std::this_thread::yield();  // another one may fail and leave something
                continue;
            }
            volatile std::uint64_t spin = own.below(2000);
            while (spin > 0) spin = spin - 1;
            if (count++ >= fails_after[i]) return queue.retire(i, chunk);
            ++done[*chunk];
            --undone;
        }
    };
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < takers.size(); ++i) threads.emplace_back(device, i, random.bits());
    for (std::thread& thread : threads) thread.join();
    Run result;
    for (const std::atomic<std::uint32_t>& times : done) result.done.push_back(times.load());
    result.left = queue.left();
    for (std::size_t i = 0; i < takers.size(); ++i) result.taken += queue.taken(i);
    return result;
}

}  // namespace

TEST_CASE("threads that take, steal and fail do every chunk once", "[host][schedule]") {
    for (std::uint64_t seed = 600; seed < 660; ++seed) {
        INFO("seed " << seed);
        const test::Watchdog watchdog;
        const Run run = run_threads(seed);
        CHECK(run.left == 0);
        CHECK(run.taken == run.done.size());
        CHECK(std::count(run.done.begin(), run.done.end(), 1u) == static_cast<std::ptrdiff_t>(run.done.size()));
    }
}
