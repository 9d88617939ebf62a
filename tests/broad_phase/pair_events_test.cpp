#include "src/broad_phase/pair_events.hpp"

#include <catch2/catch.hpp>
#include <set>

#include "bench/scenes/boxes.hpp"
#include "clinch/broad_phase.hpp"
#include "clinch/error.hpp"
#include "tests/broad_phase/oracle.hpp"
#include "tests/device/devices.hpp"
#include "tests/pair_lists.hpp"
#include "tests/random.hpp"

using namespace clinch;
using test::copy;
using test::without;

namespace {

std::vector<Pair> random_list(std::size_t count, test::Random& random) {
    std::set<Pair> pairs;
    while (pairs.size() < count) {
        const auto a = static_cast<std::uint32_t>(random.below(count)),
                   b = static_cast<std::uint32_t>(random.below(50));
        pairs.insert({a, a + 1 + b});
    }
    return {pairs.begin(), pairs.end()};
}

}  // namespace

TEST_CASE("events are the difference of two lists", "[host]") {
    test::Random random(4);
    detail::PairEvents events;
    std::vector<Pair> last;
    for (const std::size_t count : {0u, 1u, 30u, 31u, 5000u, 200000u, 200000u, 3u, 0u}) {
        std::vector<Pair> now = random_list(count, random);
        for (int step = 0; step < 3; ++step) {
            INFO(count << " " << step);
            events.update(now);
            CHECK(copy(events.added()) == without(now, last));
            CHECK(copy(events.removed()) == without(last, now));
            last = now;
            for (int k = 0; k < 20 && !now.empty(); ++k)  // a few come and go
                now.erase(now.begin() + static_cast<std::ptrdiff_t>(random.below(now.size())));
            now.push_back({static_cast<std::uint32_t>(count), static_cast<std::uint32_t>(count) + 60});
        }
    }
    events.start_afresh();
    events.update(last);
    CHECK(copy(events.added()) == last);
    CHECK(events.removed().empty());
}

TEST_CASE("a broad phase tells which pairs came and went", "[device]") {
    Context context;
    BroadPhaseOptions options;
    options.events = true;
    BroadPhase broad_phase(context, options);
    test::Random random(5);
    std::vector<Aabb> boxes = scenes::make_boxes("density", 11000, 2);
    std::vector<Pair> last;
    for (int frame = 0; frame < 8; ++frame) {
        INFO(frame);
        std::vector<std::uint32_t> changed;
        for (std::uint32_t i = 5; i < boxes.size(); i += 100) {
            const float by = static_cast<float>(random.between(-0.2, 0.2));
            boxes[i].min[frame % 3] += by;
            boxes[i].max[frame % 3] += by;
            changed.push_back(i);
        }
        const std::vector<Pair> now = copy(frame == 5 ? broad_phase.find(boxes) : broad_phase.update(boxes, changed));
        CHECK(now == test::pairs_by_sweep(boxes));
        CHECK(copy(broad_phase.added()) == without(now, last));
        CHECK(copy(broad_phase.removed()) == without(last, now));
        last = now;
    }
    broad_phase.update(boxes, View<const std::uint32_t>{});
    CHECK(broad_phase.added().empty());
    CHECK(broad_phase.removed().empty());

    options.order = Order::Any;
    CHECK_THROWS_AS(BroadPhase(context, options), Error);
}
