#include "src/broad_phase/incremental.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <set>

#include "bench/scenes/boxes.hpp"
#include "clinch/broad_phase.hpp"
#include "clinch/error.hpp"
#include "tests/broad_phase/oracle.hpp"
#include "tests/device/devices.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

bool same(View<const Pair> found, const std::vector<Pair>& expected) {
    return found.size() == expected.size() &&
           (expected.empty() || std::memcmp(found.data(), expected.data(), expected.size() * sizeof(Pair)) == 0);
}

// A world in which a few things happen each frame.
struct World {
    std::vector<Aabb> boxes;
    std::vector<std::uint32_t> group, mask;
    std::vector<Motion> motion;
    test::Random random{7};

    World(const std::string& kind, std::size_t n) : boxes(scenes::make_boxes(kind, n, 3)) {
        for (std::size_t i = 0; i < n; ++i) {
            group.push_back(1u << random.below(3));
            mask.push_back(random.below(4) == 0 ? 3u : 7u);
            motion.push_back(random.below(3) == 0 ? Motion::Static : Motion::Dynamic);
        }
    }
    FilterColumns filters() const { return {group.data(), mask.data(), motion.data()}; }

    // `count` boxes move a little, each seldom far; now and then one is no box, or grows. Ascending.
    std::vector<std::uint32_t> move(std::size_t count) {
        std::set<std::uint32_t> changed;
        while (changed.size() < count) changed.insert(static_cast<std::uint32_t>(random.below(boxes.size())));
        for (const std::uint32_t i : changed) {
            Aabb& box = boxes[i];
            const std::size_t what = random.below(40);
            if (!(box.min[0] <= box.max[0])) box = boxes[(i + 1) % boxes.size()];
            const double reach = what == 0 ? 10.0 : 0.02;
            for (int d = 0; d < 3; ++d) {
                const float by =
                    static_cast<float>(reach * (static_cast<double>(random.below(2001)) - 1000.0) / 1000.0);
                box.min[d] += by;
                box.max[d] += by;
            }
            if (what == 1) box.min[random.below(3)] = std::nanf("");
            if (what == 2) box.max[random.below(3)] += 3.0f;
        }
        return {changed.begin(), changed.end()};
    }
    // Some of the changed bodies get other filters.
    void change_filters(const std::vector<std::uint32_t>& changed) {
        for (std::size_t k = 0; k < changed.size(); k += 3) {
            group[changed[k]] = 1u << random.below(3);
            motion[changed[k]] = random.below(2) == 0 ? Motion::Sleeping : Motion::Dynamic;
        }
    }
};

// Steps the incremental path itself, which the public calls only take for many boxes.
void check_steps(detail::Device& device, const std::string& kind, std::size_t n, int frames, bool filtered) {
    World world(kind, n);
    const auto filters = [&] { return filtered ? world.filters() : FilterColumns{}; };
    const BroadPhaseOptions options;
    detail::Incremental incremental(device, options);
    detail::Buffer staging;
    int stepped = 0;
    for (int frame = 0; frame < frames; ++frame) {
        INFO(kind << " frame " << frame << " filtered " << filtered);
        const std::vector<std::uint32_t> changed = world.move(frame == 0 ? 0 : 1 + n / 100);
        if (filtered && frame % 4 == 2) world.change_filters(changed);
        std::vector<Aabb> rows;
        for (const std::uint32_t i : changed) rows.push_back(world.boxes[i]);

        detail::PairList pairs;
        detail::FindCounts counts;
        bool done = false;
        if (incremental.valid()) {
            detail::BoxInput there(device, staging.handle(), 0, static_cast<std::uint32_t>(n));
            done = incremental.update(there, {changed, rows.data(), false}, {filters(), 0}, pairs, counts);
            stepped += done ? 1 : 0;
        }
        if (!done) {
            CHECK(pairs.size() == 0);
            detail::BoxInput all(world.boxes, staging);
            REQUIRE(incremental.build(all, {filters(), 0}, pairs, counts));
        }
        CHECK(same(pairs.view(), test::pairs_by_hand(world.boxes, filters())));
        const bool any_invalid = std::any_of(world.boxes.begin(), world.boxes.end(), [](const Aabb& box) {
            return !(box.min[0] <= box.max[0] && box.min[1] <= box.max[1] && box.min[2] <= box.max[2]);
        });
        CHECK((counts.invalid_boxes || !any_invalid));
    }
    CHECK(stepped > frames / 2);
}

}  // namespace

TEST_CASE("pairs kept from step to step are those of a search", "[device]") {
    for (std::uint32_t i = 0; i < list_devices().size(); ++i) {
        if (!detail::runs_on(detail::algorithm_named("grid"), list_devices()[i])) continue;
        for (const std::uint32_t lanes : {1u, 4u, 8u, 16u}) {
            const Context context = test::with_lanes(i, lanes);
            detail::Device& device = context.impl().open(0);
            INFO("device " << i << " lanes " << lanes);
            check_steps(device, "density", 3000, 30, false);
            check_steps(device, "uniform", 2000, 20, true);
            check_steps(device, "mixed", 1500, 12, true);
        }
    }
}

TEST_CASE("a few steps of the incremental path", "[device][small]") {
    for (std::uint32_t i = 0; i < list_devices().size(); ++i) {
        if (!detail::runs_on(detail::algorithm_named("grid"), list_devices()[i])) continue;
        const Context context = test::with_lanes(i, 1);
        check_steps(context.impl().open(0), "density", 400, 5, true);
    }
}

TEST_CASE("updates of many boxes give what a search gives", "[device]") {
    constexpr std::size_t n = 12000;
    for (std::uint32_t i = 0; i < list_devices().size(); ++i) {
        Context context = test::with_lanes(i, list_devices()[i].lanes);
        World world("density", n);
        BroadPhase broad_phase(context), fresh(context);
        const std::vector<std::uint32_t> none;
        CHECK(same(broad_phase.update(world.boxes, none), test::pairs_by_sweep(world.boxes)));
        for (int frame = 0; frame < 6; ++frame) {
            INFO("device " << i << " frame " << frame);
            const std::vector<std::uint32_t> changed = world.move(frame == 4 ? n / 2 : 100);
            const View<const Pair> found = broad_phase.update(world.boxes, changed);
            CHECK(same(found, test::pairs_by_sweep(world.boxes)));
            const View<const Pair> again = broad_phase.update(world.boxes, none);
            CHECK(same(again, test::pairs_by_sweep(world.boxes)));
            CHECK(broad_phase.report().skipped.unchanged == n);
            CHECK(broad_phase.report().box_tests == 0);
            fresh.find(world.boxes);
            if (frame == 3) {
                broad_phase.update(world.boxes, changed);
                CHECK(broad_phase.report().rejected.size() == fresh.report().rejected.size());
            }
        }
        const std::vector<std::uint32_t> beyond{static_cast<std::uint32_t>(n)};
        CHECK_THROWS_AS(broad_phase.update(world.boxes, beyond), Error);
        world.boxes.resize(n / 2);  // other boxes
        CHECK(same(broad_phase.update(world.boxes, none), test::pairs_by_sweep(world.boxes)));
    }
}

TEST_CASE("updates need no device", "[host]") {
    Context context = Context::host_only();
    World world("density", 800);
    BroadPhase broad_phase(context);
    for (int frame = 0; frame < 4; ++frame) {
        const std::vector<std::uint32_t> changed = world.move(20);
        CHECK(same(broad_phase.update(world.boxes, changed), test::pairs_by_hand(world.boxes)));
    }
}

TEST_CASE("updates with more pairs than one buffer holds are searches", "[device]") {
    World world("grid-touch", 12000);  // 13 pairs a box, and no more in fattened boxes
    for (std::uint32_t i = 0; i < list_devices().size(); ++i) {
        Context context = test::with_lanes(i, list_devices()[i].lanes);
        context.impl().infos[0].max_allocation = std::size_t{1} << 20;
        BroadPhase broad_phase(context);
        broad_phase.find(world.boxes);
        for (int frame = 0; frame < 3; ++frame) {
            INFO("device " << i << " frame " << frame);
            const std::vector<std::uint32_t> changed = world.move(50);
            const View<const Pair> found = broad_phase.update(world.boxes, changed);
            CHECK(found.size() * sizeof(Pair) > std::size_t{1} << 20);
            CHECK(same(found, test::pairs_by_sweep(world.boxes)));
            CHECK(broad_phase.report().algorithm != "incremental");
        }
    }
}
