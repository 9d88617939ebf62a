#include "src/schedule/chunk_buffer.hpp"

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/random.hpp"
#include "tests/watchdog.hpp"

using namespace clinch;
using detail::ChunkBuffer;

TEST_CASE("a chunk buffer keeps the order and ends when its producers do", "[host][schedule]") {
    ChunkBuffer<int> buffer(3, 1);
    CHECK(buffer.put(1));
    CHECK(buffer.put(2));
    CHECK(buffer.take() == 1);
    CHECK(buffer.put(3));
    CHECK(buffer.put(4));
    int more = 6;
    CHECK_FALSE(buffer.try_put(more));
    CHECK(more == 6);
    buffer.add_producer();
    buffer.producer_done();
    CHECK(buffer.take() == 2);
    buffer.producer_done();
    CHECK(buffer.take() == 3);
    CHECK(buffer.take() == 4);
    CHECK_FALSE(buffer.take());
    CHECK_FALSE(buffer.cancelled());
    CHECK_FALSE(buffer.try_take());
    int item = 5;
    CHECK(buffer.try_put(item));
    CHECK(buffer.try_take() == 5);
    CHECK(buffer.most_held() == 3);
    CHECK_THROWS_AS(ChunkBuffer<int>(0), Error);
}

TEST_CASE("a cancelled chunk buffer gives and takes nothing", "[host][schedule]") {
    ChunkBuffer<std::unique_ptr<int>> buffer(2, 1);
    CHECK(buffer.put(std::make_unique<int>(1)));
    buffer.cancel();
    CHECK_FALSE(buffer.take());
    CHECK_FALSE(buffer.put(std::make_unique<int>(2)));
    std::unique_ptr<int> dropped = std::make_unique<int>(3);
    CHECK(buffer.try_put(dropped));
    CHECK_FALSE(buffer.try_take());
    CHECK(buffer.cancelled());
}

TEST_CASE("cancelling wakes those who wait on either side", "[host][schedule]") {
    for (const bool full : {false, true}) {
        INFO("waiting while it is " << (full ? "full" : "empty"));
        ChunkBuffer<int> buffer(1, 1);
        if (full) CHECK(buffer.put(1));
        std::atomic<bool> refused{false};
        const test::Watchdog watchdog;
        std::thread waiting([&buffer, &refused, full] { refused = full ? !buffer.put(2) : !buffer.take(); });
        for (int i = 0; i < 1000; ++i) std::this_thread::yield();  // mostly it waits by then
        buffer.cancel();
        waiting.join();
        CHECK(refused);
    }
}

namespace {

enum class Fails { Nobody, Producer, Consumer };

struct Streamed {
    std::vector<std::uint32_t> taken;
    std::uint32_t put = 0;
    std::size_t most_held = 0;
    int caught = 0;
    bool cancelled = false;
};

// Producers put 0 .. 999 between them, some of them taking items themselves while there is no room; one side may throw
// at a random place.
Streamed stream(std::uint64_t seed, Fails fails) {
    test::Random random(seed);
    const std::size_t producers = 1 + random.below(4), consumers = 1 + random.below(4);
    const auto fails_at = static_cast<std::uint32_t>(random.below(1000));
    ChunkBuffer<std::uint32_t> buffer(1 + random.below(5), producers);
    std::vector<std::atomic<std::uint32_t>> taken(1000);
    std::atomic<std::uint32_t> next{0}, put{0}, count{0};
    std::atomic<int> caught{0};
    const auto guarded = [&caught](const auto& body) {
        try {
            body();
        } catch (const std::runtime_error&) {
            ++caught;
        }
    };
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < producers; ++i)
        threads.emplace_back(guarded, [&, helps = fails != Fails::Consumer && random.below(2) == 0] {
            const ChunkBuffer<std::uint32_t>::Producer producer(buffer);
            for (std::uint32_t k = next++; k < 1000; k = next++) {
                if (fails == Fails::Producer && k == fails_at) throw std::runtime_error("producer");
                if (helps) {
                    std::uint32_t item = k;
                    while (!buffer.try_put(item))
                        if (const std::optional<std::uint32_t> other = buffer.try_take()) ++taken[*other];
                    if (buffer.cancelled()) return;
                } else if (!buffer.put(k)) {
                    return;
                }
                ++put;
            }
        });
    for (std::size_t i = 0; i < consumers; ++i)
        threads.emplace_back(guarded, [&] {
            const ChunkBuffer<std::uint32_t>::Consumer consumer(buffer);
            while (const std::optional<std::uint32_t> k = buffer.take()) {
                ++taken[*k];
                if (fails == Fails::Consumer && count++ == fails_at) throw std::runtime_error("consumer");
            }
        });
    for (std::thread& thread : threads) thread.join();
    Streamed result;
    for (const std::atomic<std::uint32_t>& times : taken) result.taken.push_back(times.load());
    result.put = put.load();
    result.most_held = buffer.most_held();
    result.caught = caught.load();
    result.cancelled = buffer.cancelled();
    return result;
}

}  // namespace

TEST_CASE("producers and consumers pass every item once", "[host][schedule]") {
    for (std::uint64_t seed = 700; seed < 720; ++seed) {
        INFO("seed " << seed);
        const test::Watchdog watchdog;
        const Streamed found = stream(seed, Fails::Nobody);
        CHECK(found.taken == std::vector<std::uint32_t>(1000, 1));
        CHECK(found.put == 1000);
        CHECK(found.most_held >= 1);
        CHECK(found.most_held <= 5);
        CHECK_FALSE(found.cancelled);
    }
}

TEST_CASE("an exception of one side does not hang the other", "[host][schedule]") {
    for (std::uint64_t seed = 720; seed < 760; ++seed) {
        INFO("seed " << seed);
        const test::Watchdog watchdog;
        const Streamed found = stream(seed, seed % 2 == 0 ? Fails::Producer : Fails::Consumer);
        CHECK(found.caught == 1);
        CHECK(found.cancelled);
        CHECK(*std::max_element(found.taken.begin(), found.taken.end()) <= 1);
    }
}
