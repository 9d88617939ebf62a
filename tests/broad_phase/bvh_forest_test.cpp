// Bodies that cannot move, which bvh keeps in a tree of their own: the pairs stay right whatever they do.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "bench/scenes/boxes.hpp"
#include "clinch/broad_phase.hpp"
#include "src/broad_phase/bvh_forest.hpp"
#include "tests/broad_phase/every_algorithm.hpp"
#include "tests/broad_phase/oracle.hpp"
#include "tests/device/devices.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

BroadPhaseOptions bvh_options() {
    BroadPhaseOptions options;
    options.algorithm = "bvh";
    return options;
}

bool cannot_move(Motion motion) {
    return motion == Motion::Static || motion == Motion::Sleeping;
}

// Boxes of which some cannot move, and what happens to them.
struct World {
    std::vector<Aabb> boxes;
    test::Filters filters;
    test::Random random;

    // `percent` of the bodies cannot move. Some boxes of either kind are no boxes.
    World(const char* kind, std::size_t n, unsigned percent, std::uint64_t seed)
        : boxes(scenes::make_boxes(kind, n, seed)), filters(), random(seed) {
        filters = test::random_filters(n, random);
        for (Motion& motion : filters.motion) motion = any_motion(random.below(100) < percent);
        for (std::size_t i = 0; i < n / 300; ++i) any().max[random.below(3)] = std::numeric_limits<float>::quiet_NaN();
    }
    Motion any_motion(bool still) {
        const bool second = random.below(2) == 0;
        if (still) return second ? Motion::Static : Motion::Sleeping;
        return second ? Motion::Dynamic : Motion::Kinematic;
    }
    Aabb& any() { return boxes[random.below(boxes.size())]; }
    void shift(Aabb& box, double most) {
        for (int d = 0; d < 3; ++d) {
            const auto by = static_cast<float>(random.between(-most, most));
            box.min[d] += by;
            box.max[d] += by;
        }
    }
    void step() {
        for (std::size_t i = 0; i < boxes.size(); ++i)
            if (!cannot_move(filters.motion[i])) shift(boxes[i], 0.05);
    }
    std::size_t first(bool still) const {
        const auto found = std::find_if(filters.motion.begin(), filters.motion.end(),
                                        [&](Motion motion) { return cannot_move(motion) == still; });
        return static_cast<std::size_t>(found - filters.motion.begin());
    }
    // What a frame brings besides the movers' steps. Returns whether bodies that cannot move changed.
    bool event(int frame) {
        const std::size_t still = first(true), mover = first(false);
        switch (frame % 8) {
            case 1:  // one that cannot move does after all, by very little
                if (still == boxes.size()) return false;
                boxes[still].min[2] = std::nextafter(boxes[still].min[2], -1e9f);
                return true;
            case 3:  // one falls asleep
                if (mover == boxes.size()) return false;
                filters.motion[mover] = Motion::Sleeping;
                return true;
            case 4:  // one wakes
                if (still == boxes.size()) return false;
                filters.motion[still] = Motion::Dynamic;
                return true;
            case 6:  // one stops being a box, or is one again
                if (still == boxes.size()) return false;
                boxes[still].max[0] = std::isfinite(boxes[still].max[0]) ? std::numeric_limits<float>::infinity()
                                                                         : boxes[still].min[0] + 1.0f;
                return true;
            case 7:  // and another kind of resting is none the less resting
                if (still < boxes.size())
                    filters.motion[still] = filters.motion[still] == Motion::Static ? Motion::Sleeping : Motion::Static;
                return false;
            default:
                return false;
        }
    }
};

// Frames of a world: the oracle's bytes in each, with motion alone and with groups and masks too.
void check_world(Context& context, World world, int frames) {
    BroadPhase motion_only(context, bvh_options()), all(context, bvh_options());
    for (int frame = 0; frame < frames; ++frame) {
        INFO("frame " << frame);
        FilterColumns motion;
        motion.motion = world.filters.motion.data();
        const std::vector<Pair> expected = test::pairs_by_sweep(world.boxes, motion);
        CHECK(test::same(motion_only.find(world.boxes, motion), expected));
        CHECK(test::same(all.find(world.boxes, world.filters.columns()),
                         test::pairs_by_sweep(world.boxes, world.filters.columns())));
        const auto rejected = static_cast<std::size_t>(
            std::count_if(world.boxes.begin(), world.boxes.end(), [](const Aabb& box) { return !test::is_box(box); }));
        CHECK(all.report().rejected.size() == rejected);
        CHECK(motion_only.count(world.boxes, motion) == expected.size());
        world.step();
        world.event(frame);
    }
}

// The forest alone, asked whether it kept the tree.
struct Forest {
    detail::Device& device;
    detail::Buffer staging;
    detail::BvhForest trees;

    explicit Forest(Context& context, std::uint32_t fewest) : device(context.impl().open(0)), trees(device, fewest) {}
    std::uint32_t update(const World& world, std::uint64_t version = 0) {
        detail::BoxInput input(world.boxes, staging);
        trees.update(input, {world.filters.columns(), version});
        return trees.kept();
    }
};

std::uint32_t still_in(const World& world) {
    return static_cast<std::uint32_t>(
        std::count_if(world.filters.motion.begin(), world.filters.motion.end(), cannot_move));
}

}  // namespace

TEST_CASE("bvh: still bodies of any share give the oracle's bytes in every frame", "[device]") {
    constexpr std::size_t n = detail::BvhForest::fewest_boxes + 500;
    for (std::uint32_t device = 0; device < list_devices().size(); ++device)
        for (const std::uint32_t lanes : {1u, 8u, 16u}) {
            Context context = test::with_lanes(device, lanes);
            for (const unsigned percent : {0u, 10u, 30u, 60u, 95u, 100u}) {
                INFO("device " << device << ", lanes " << lanes << ", " << percent << " % still");
                check_world(context, World("density", n, percent, 70 + percent), 9);
            }
            check_world(context, World("mixed", n, 90, 5), 3);
            check_world(context, World("clusters", n, 70, 6), 3);
        }
}

TEST_CASE("bvh: still bodies where loops end early", "[device]") {
    for (const std::uint32_t lanes : {1u, 16u}) {
        Context context = test::with_lanes(0, lanes);
        context.impl().infos[0].name += " (as llvmpipe)";
        check_world(context, World("clusters", 9000, 80, 3), 3);
        check_world(context, World("clusters", 9000, 50, 3), 2);
    }
}

TEST_CASE("bvh: the tree of still bodies is kept while they are as they were", "[device]") {
    Context context = test::with_lanes(0, 1);
    World world("density", 300, 80, 9);
    Forest forest(context, 100);
    CHECK(forest.update(world) == 0);
    REQUIRE(forest.trees.split());
    for (int frame = 0; frame < 16; ++frame) {
        INFO("frame " << frame);
        world.step();
        const bool changed = world.event(frame);
        CHECK(forest.update(world) == (changed ? 0 : still_in(world)));
        CHECK(forest.update(world) == still_in(world));
        CHECK(forest.trees.any_invalid());
    }
    // Few are left: one tree again, though not at once.
    for (std::size_t i = 0; i < 300; ++i) world.filters.motion[i] = i % 4 == 0 ? Motion::Static : Motion::Dynamic;
    CHECK(forest.update(world) == 0);
    CHECK(forest.trees.split());
    for (std::size_t i = 0; i < 300; ++i) world.filters.motion[i] = i % 30 == 0 ? Motion::Static : Motion::Dynamic;
    CHECK(forest.update(world) == 0);
    CHECK_FALSE(forest.trees.split());
    CHECK(forest.update(world) == 0);
    for (Motion& motion : world.filters.motion) motion = Motion::Static;
    CHECK(forest.update(world) == 0);
    CHECK(forest.trees.split());
    CHECK(forest.trees.moving() == nullptr);
    CHECK(forest.update(world) == 300);
}

// First what needs most memory, then always less: oclgrind 21.10 knows nothing of the new part of a buffer that was
// made larger, and reports what was written there as never written.
TEST_CASE("bvh: still bodies, moved and exchanged", "[device][small]") {
    Context context = test::with_lanes(0, 1);
    World world("density", detail::BvhForest::fewest_boxes, 90, 9);
    BroadPhase broad_phase(context, bvh_options());
    CHECK(broad_phase.find(world.boxes).size() > 1000);
    for (int frame = 0; frame < 3; ++frame) {
        INFO("frame " << frame);
        CHECK(test::same(broad_phase.find(world.boxes, world.filters.columns()),
                         test::pairs_by_sweep(world.boxes, world.filters.columns())));
        CHECK(broad_phase.report().skipped.still == (frame == 1 ? still_in(world) : 0));
        const std::size_t still = world.first(true), mover = world.first(false);
        world.step();
        if (frame == 1) {
            world.shift(world.boxes[still], 0.5);
            std::swap(world.filters.motion[still], world.filters.motion[mover]);
        }
    }
}

TEST_CASE("bvh: filters with the version of the last call are not looked at again", "[device]") {
    Context context = test::with_lanes(0, 8);
    World world("density", 900, 50, 9);
    Forest forest(context, 100);
    const std::uint32_t still = still_in(world);
    CHECK(forest.update(world, 5) == 0);
    CHECK(forest.update(world, 5) == still);
    world.filters.motion[world.first(true)] = Motion::Dynamic;
    CHECK(forest.update(world, 6) == 0);
    CHECK(forest.update(world, 0) == still - 1);
    CHECK(forest.update(world, 6) == still - 1);
}

TEST_CASE("bvh: kept still bodies are in the report", "[device]") {
    Context context = test::with_lanes(0, 16);
    World world("density", detail::BvhForest::fewest_boxes, 90, 2);
    BroadPhase broad_phase(context, bvh_options());
    broad_phase.find(world.boxes, world.filters.columns());
    CHECK(broad_phase.report().skipped.still == 0);
    broad_phase.find(world.boxes, world.filters.columns());
    CHECK(broad_phase.report().skipped.still == still_in(world));
    const std::uint64_t tests = broad_phase.report().box_tests;
    broad_phase.find(world.boxes);
    CHECK(broad_phase.report().skipped.still == 0);
    CHECK(broad_phase.report().box_tests > tests);
}
