// What every broad-phase algorithm must do, for each row of the registry on each device.
#include <catch2/catch.hpp>
#include <limits>
#include <string>
#include <vector>

#include "bench/scenes/boxes.hpp"
#include "clinch/broad_phase.hpp"
#include "clinch/error.hpp"
#include "tests/broad_phase/every_algorithm.hpp"
#include "tests/broad_phase/oracle.hpp"
#include "tests/device/devices.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

// Boxes of many sizes, some flat, some touching exactly, some no boxes.
std::vector<Aabb> hostile_boxes(std::size_t n, test::Random& random) {
    constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<Aabb> boxes(n);
    const double far = random.below(3) == 0 ? 1e7 : 0.0;
    for (Aabb& box : boxes) {
        for (int d = 0; d < 3; ++d) {
            const double size = random.below(4) == 0 ? 0.0 : static_cast<double>(random.below(3));
            box.min[d] = static_cast<float>(far + static_cast<double>(random.below(12)));
            box.max[d] = static_cast<float>(box.min[d] + size);
        }
        const std::size_t d = random.below(3);
        switch (random.below(40)) {
            case 0:
                box.min[d] = nan;
                break;
            case 1:
                box.max[d] = nan;
                break;
            case 2:
                box.max[d] = inf;
                break;
            case 3:
                box.min[d] = -inf;
                break;
            case 4:
                box.max[d] = box.min[d] - 1.0f;
                break;
            case 5:
                box.min[d] = box.max[d] = std::numeric_limits<float>::max();
                break;
            case 6:
                box.min[d] = box.max[d] = -0.0f;
                break;
            case 7:
                box.min[d] = -1e-40f, box.max[d] = 1e-40f;
                break;
            default:
                break;
        }
    }
    return boxes;
}

void check_small(const std::vector<std::uint32_t>& lanes, std::size_t n) {
    const std::vector<Aabb> boxes = scenes::make_boxes("density", n, 7);
    const std::vector<Pair> expected = test::pairs_by_hand(boxes);
    REQUIRE(expected.size() > n / 2);
    test::Random random(31);
    const test::Filters filters = test::random_filters(boxes.size(), random);
    const std::vector<Pair> filtered = test::pairs_by_hand(boxes, filters.columns());
    test::with_each(test::settings(lanes), test::default_scratch, [&](BroadPhase& broad_phase) {
        test::check_scene(broad_phase, boxes, {}, expected);
        test::check_scene(broad_phase, boxes, filters.columns(), filtered);
    });
}

}  // namespace

TEST_CASE("all algorithms give the oracle's bytes, small", "[device][small]") {
    check_small({1}, 450);
}

// Apart from the above since oclgrind can check vector code for races and bad accesses only (see tests/oclgrind).
TEST_CASE("all algorithms give the oracle's bytes, small, in vectors", "[device][builds][vectors]") {
    check_small({4, 16}, 450);
}

TEST_CASE("all algorithms give the oracle's bytes on every kind of scene", "[device][builds]") {
    const std::vector<scenes::BoxKind> kinds = scenes::box_kinds();
    std::vector<std::vector<Aabb>> boxes;
    std::vector<std::vector<Pair>> expected;
    for (const scenes::BoxKind& kind : kinds) {
        boxes.push_back(scenes::make_boxes(kind.name, kind.all_pairs ? 500 : 3000, 5));
        expected.push_back(test::pairs_by_hand(boxes.back()));
        REQUIRE(!expected.back().empty());
    }
    // One after the other with the same buffers.
    test::with_each(test::settings(test::all_lanes), test::default_scratch, [&](BroadPhase& broad_phase) {
        for (std::size_t i = 0; i < kinds.size(); ++i) {
            INFO(kinds[i].name);
            test::check_scene(broad_phase, boxes[i], {}, expected[i]);
        }
    });
}

TEST_CASE("10,000 boxes of uniform: the oracle's bytes", "[device]") {
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", 10000, 1);
    const std::vector<Pair> expected = test::pairs_by_hand(boxes);
    REQUIRE(expected.size() > 8000);
    test::with_each(test::settings({}), test::default_scratch,
                    [&](BroadPhase& broad_phase) { test::check_scene(broad_phase, boxes, {}, expected); });
}

TEST_CASE("random sizes of hostile boxes, filtered or not", "[device][builds]") {
    const std::uint64_t seed = 32;
    test::Random random(seed);
    struct Case {
        std::vector<Aabb> boxes;
        test::Filters filters;
        bool filtered;
    };
    std::vector<Case> cases;
    for (int i = 0; i < 80; ++i) {
        Case c;
        c.boxes = hostile_boxes(random.below(i % 20 < 2 ? 1800 : 300), random);
        c.filters = test::random_filters(c.boxes.size(), random);
        c.filtered = random.below(2) == 0;
        cases.push_back(std::move(c));
    }
    std::vector<std::vector<Pair>> expected;
    for (const Case& c : cases)
        expected.push_back(test::pairs_by_hand(c.boxes, c.filtered ? c.filters.columns() : FilterColumns{}));
    // Small scratch memory: several batches and several fills even for small scenes. Each run takes every second case.
    std::size_t run = 0;
    for (const std::size_t scratch : {test::default_scratch, std::size_t{20000}})
        test::with_each(test::settings(test::all_lanes), scratch, [&](BroadPhase& broad_phase) {
            for (std::size_t i = run++ % 2; i < cases.size(); i += 2) {
                INFO("seed " << seed << ", case " << i);
                test::check_scene(broad_phase, cases[i].boxes,
                                  cases[i].filtered ? cases[i].filters.columns() : FilterColumns{}, expected[i]);
            }
        });
}

TEST_CASE("no box, one box, two equal boxes, all boxes at one place", "[device][small]") {
    const Aabb unit{{0, 0, 0}, {1, 1, 1}};
    const std::size_t many = 90;
    const std::vector<Aabb> all(many, unit);
    std::vector<Pair> every;
    for (std::uint32_t a = 0; a < many; ++a)
        for (std::uint32_t b = a + 1; b < many; ++b) every.push_back({a, b});
    test::with_each(test::settings({1}), 1000, [&](BroadPhase& broad_phase) {
        CHECK(broad_phase.find(View<const Aabb>{}).empty());
        CHECK(broad_phase.find({&unit, 1}).empty());
        CHECK(broad_phase.report().rejected.empty());
        test::check_scene(broad_phase, {unit, unit}, {}, {{0, 1}});
        test::check_scene(broad_phase, all, {}, every);
    });
}

TEST_CASE("boxes that touch are pairs, boxes one ulp apart are not", "[device][small]") {
    const float next = std::nextafter(1.0f, 2.0f);
    std::vector<Aabb> boxes{{{0, 0, 0}, {1, 1, 1}}};
    for (int d = 0; d < 3; ++d) {
        Aabb touching{{0, 0, 0}, {1, 1, 1}}, apart = touching;
        touching.min[d] = 1.0f, touching.max[d] = 2.0f;
        apart.min[d] = next, apart.max[d] = 2.0f;
        boxes.push_back(touching);
        boxes.push_back(apart);
    }
    const std::vector<Pair> expected = test::pairs_by_hand(boxes);
    CHECK(std::count_if(expected.begin(), expected.end(), [](const Pair& p) { return p.a == 0; }) == 3);
    test::with_each(test::settings({1}), test::default_scratch,
                    [&](BroadPhase& broad_phase) { test::check_scene(broad_phase, boxes, {}, expected); });
}

TEST_CASE("boxes that are no boxes are named with the reason", "[device]") {
    constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    const Aabb unit{{0, 0, 0}, {1, 1, 1}};
    std::vector<Aabb> boxes(6, unit);
    boxes[1].min[1] = nan;
    boxes[3].max[2] = inf;
    boxes[4].min[0] = 2.0f;
    test::with_each(test::settings({1, 16}), test::default_scratch, [&](BroadPhase& broad_phase) {
        test::check_scene(broad_phase, boxes, {}, {{0, 2}, {0, 5}, {2, 5}});
        const auto& rejected = broad_phase.report().rejected;
        REQUIRE(rejected.size() == 3);
        CHECK(rejected[0].body == 1);
        CHECK(rejected[0].why == "min y is nan and must be finite");
        CHECK(rejected[1].body == 3);
        CHECK(rejected[1].why == "max z is inf and must be finite");
        CHECK(rejected[2].body == 4);
        CHECK(rejected[2].why == "min x is 2 and must not be greater than max x, 1");
        broad_phase.find({&boxes[4], 1});
        CHECK(broad_phase.report().rejected.size() == 1);
    });
}

TEST_CASE("what filters drop is counted", "[device]") {
    const std::vector<Aabb> boxes(4, Aabb{{0, 0, 0}, {1, 1, 1}});
    const std::vector<std::uint32_t> group{1, 1, 2, 1}, mask{1, 1, 0xff, 0xff};
    const std::vector<Motion> motion{Motion::Static, Motion::Sleeping, Motion::Dynamic, Motion::Kinematic};
    test::with_each(test::settings({1, 16}), test::default_scratch, [&](BroadPhase& broad_phase) {
        // 2 is in group 2, which 0 and 1 do not want; 0 and 1 do not move.
        test::check_scene(broad_phase, boxes, {group.data(), mask.data(), motion.data()}, {{0, 3}, {1, 3}, {2, 3}});
        CHECK(broad_phase.report().skipped.pairs_filtered == 2);
        CHECK(broad_phase.report().skipped.static_pairs == 1);
    });
}

TEST_CASE("a limit on pairs is an error that names the true count", "[device]") {
    const std::vector<Aabb> boxes(600, Aabb{{0, 0, 0}, {1, 1, 1}});
    for (const test::Setting& setting : test::settings({8})) {
        INFO(setting.text());
        Context context = test::with_lanes(setting.device, setting.lanes);
        BroadPhaseOptions options;
        options.algorithm = setting.name;
        options.max_pairs = 1000;
        options.scratch_bytes = 20000;
        BroadPhase broad_phase(context, options);
        try {
            broad_phase.find(boxes);
            FAIL("no error");
        } catch (const Error& error) {
            CHECK(error.code() == ErrorCode::LimitExceeded);
            CHECK(std::string(error.what()).find("179700") != std::string::npos);
        }
        CHECK(broad_phase.find({boxes.data(), 45}).size() == 990);  // and goes on working
    }
}

TEST_CASE("progress rises to the end and may stop the work", "[device]") {
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", 4000, 3);
    Context context = test::with_lanes(0, 8);
    double last = 0.0;
    int calls = 0;
    bool stop = false;
    BroadPhaseOptions options;
    options.algorithm = "brute";
    options.scratch_bytes = 200000;
    options.progress = [&](double share) {
        CHECK(share >= last);
        CHECK(share <= 1.0);
        last = share;
        ++calls;
        if (stop) throw std::runtime_error("stopped");
    };
    BroadPhase broad_phase(context, options);
    const std::size_t pairs = broad_phase.find(boxes).size();
    CHECK(last == 1.0);
    CHECK(calls > 3);
    stop = true;
    last = 0.0;
    CHECK_THROWS_WITH(broad_phase.find(boxes), "stopped");
    stop = false;
    last = 0.0;
    CHECK(broad_phase.find(boxes).size() == pairs);
}

TEST_CASE("an unknown algorithm and a missing device are named", "[host]") {
    Context context = Context::host_only();
    BroadPhaseOptions options;
    options.algorithm = "fastest";
    std::string accepted = "auto";
    for (const std::string& name : broad_phase_names()) accepted += ", " + name;
    CHECK_THROWS_WITH(BroadPhase(context, options),
                      "there is no broad-phase algorithm 'fastest'; accepted are " + accepted);
    options.algorithm = "brute";
    CHECK_THROWS_AS(BroadPhase(context, options), Error);
    options.algorithm = "auto";
    BroadPhase broad_phase(context, options);
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", 1000, 7);
    CHECK(test::same(broad_phase.find(boxes), test::pairs_by_hand(boxes)));
    CHECK(broad_phase.report().algorithm == "host-sweep");
}

TEST_CASE("100,000 boxes, whose pair numbers need more than 32 bits, in bounded memory", "[device]") {
    ContextOptions one_device;
    one_device.devices.indices = {0};
    Context context(one_device);
    // llvmpipe, which has this quirk, would take a minute.
    const bool slow_device = !context.devices()[0].quirks.empty();
    const std::size_t n = slow_device ? 20000 : 100000;
    const std::vector<Aabb> boxes = scenes::make_boxes("density", n, 2);
    const std::vector<Pair> expected = test::pairs_by_sweep(boxes);
    BroadPhaseOptions options;
    options.algorithm = "brute";
    BroadPhase broad_phase(context, options);
    CHECK(test::same(broad_phase.find(boxes), expected));
    CHECK(broad_phase.report().box_tests == std::uint64_t{n} * (n - 1) / 2);
    CHECK(broad_phase.report().peak_device_bytes < 90u << 20);
}

TEST_CASE("more pairs than one buffer of the device holds", "[device]") {
    std::vector<Aabb> boxes(700, Aabb{{0, 0, 0}, {1, 1, 1}});
    for (const Aabb& box : scenes::make_boxes("uniform", 500, 6)) boxes.push_back(box);
    const std::vector<Pair> expected = test::pairs_by_hand(boxes);
    REQUIRE(expected.size() * sizeof(Pair) > 1900000);
    for (const test::Setting& setting : test::settings({8})) {
        INFO(setting.text());
        Context context = test::with_lanes(setting.device, setting.lanes);
        context.impl().infos[0].max_allocation = 700000;
        BroadPhaseOptions options;
        options.algorithm = setting.name;
        options.scratch_bytes = 500000;
        BroadPhase broad_phase(context, options);
        test::check_scene(broad_phase, boxes, {}, expected);
        test::check_scene(broad_phase, boxes, {}, expected);
    }
}
