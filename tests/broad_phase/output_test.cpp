// Pairs as a stream and as a count, for each algorithm of the registry on each device.
#include <algorithm>
#include <catch2/catch.hpp>
#include <functional>
#include <stdexcept>

#include "bench/scenes/boxes.hpp"
#include "clinch/broad_phase.hpp"
#include "clinch/error.hpp"
#include "tests/broad_phase/oracle.hpp"
#include "tests/device/devices.hpp"

using namespace clinch;

namespace {

constexpr std::size_t piece = 500;  // pairs

void with_each(Order order, const std::function<void(BroadPhase&)>& check, std::uint32_t lanes = 8) {
    for (std::uint32_t device = 0; device < list_devices().size(); ++device)
        for (const std::string& name : test::names_for(list_devices()[device])) {
            INFO("algorithm " << name << ", device " << device);
            Context context = test::with_lanes(device, lanes);
            BroadPhaseOptions options;
            options.algorithm = name;
            options.order = order;
            options.stream_bytes = piece * sizeof(Pair);
            BroadPhase broad_phase(context, options);
            check(broad_phase);
        }
}

// All that a stream hands over, each piece no longer than it may be, and ascending if `sorted`.
std::vector<Pair> streamed(BroadPhase& broad_phase, const std::vector<Aabb>& boxes, bool sorted) {
    std::vector<Pair> all;
    const std::uint64_t count = broad_phase.stream(boxes, [&](View<const Pair> pairs) {
        CHECK(pairs.size() <= piece);
        CHECK(!pairs.empty());
        CHECK((!sorted || std::is_sorted(pairs.begin(), pairs.end())));
        all.insert(all.end(), pairs.begin(), pairs.end());
    });
    CHECK(count == all.size());
    std::sort(all.begin(), all.end());
    return all;
}

}  // namespace

TEST_CASE("streams hand over every pair once, in pieces", "[device]") {
    const std::vector<Aabb> many = scenes::make_boxes("uniform", 3000, 8);  // more pairs than a piece
    std::vector<Aabb> crowd(220, Aabb{{0, 0, 0}, {1, 1, 1}});               // more pairs a box than a piece
    for (const Order order : {Order::Sorted, Order::Any}) {
        const std::vector<Pair> expected = test::pairs_by_hand(many), in_crowd = test::pairs_by_hand(crowd);
        REQUIRE(expected.size() > 500);
        with_each(order, [&](BroadPhase& broad_phase) {
            const bool sorted = order == Order::Sorted;
            CHECK(streamed(broad_phase, many, sorted) == expected);
            CHECK(broad_phase.report().pairs == expected.size());
            CHECK(streamed(broad_phase, crowd, sorted) == in_crowd);
            CHECK(streamed(broad_phase, {}, sorted).empty());
            CHECK(broad_phase.find(many).size() == expected.size());
            CHECK(streamed(broad_phase, many, sorted) == expected);
        });
    }
}

namespace {

void check_counts(std::size_t n, std::uint32_t lanes) {
    const std::vector<Aabb> boxes = scenes::make_boxes("density", n, 8);
    const std::size_t expected = test::pairs_by_hand(boxes).size();
    REQUIRE(expected > n / 2);
    const auto check = [&](BroadPhase& broad_phase) {
        CHECK(broad_phase.count(boxes) == expected);
        CHECK(broad_phase.report().pairs == expected);
        CHECK(broad_phase.find(boxes).size() == expected);
        CHECK(broad_phase.count(boxes) == expected);
        CHECK(broad_phase.count(View<const Aabb>{}) == 0);
    };
    with_each(Order::Sorted, check, lanes);
}

}  // namespace

TEST_CASE("counts are those of the list, and store nothing", "[device]") {
    check_counts(2500, 8);
}

TEST_CASE("counts are those of the list, few", "[device][small]") {
    check_counts(250, 1);
}

TEST_CASE("what the taker of a stream throws ends the call and nothing else", "[device]") {
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", 3000, 8);
    const std::size_t expected = test::pairs_by_hand(boxes).size();
    with_each(Order::Sorted, [&](BroadPhase& broad_phase) {
        CHECK_THROWS_WITH(broad_phase.stream(boxes, [](View<const Pair>) { throw std::runtime_error("enough"); }),
                          "enough");
        CHECK(broad_phase.find(boxes).size() == expected);
        CHECK_THROWS_AS(broad_phase.stream(boxes, {}), Error);
    });
}
