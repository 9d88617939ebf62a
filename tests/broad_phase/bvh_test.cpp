// What is particular to bvh: a tree that is kept while boxes move, and searches cut into windows.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "bench/scenes/boxes.hpp"
#include "clinch/broad_phase.hpp"
#include "src/broad_phase/bvh_tree.hpp"
#include "src/device/quirks.hpp"
#include "tests/broad_phase/oracle.hpp"
#include "tests/device/devices.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

bool same(View<const Pair> found, const std::vector<Pair>& expected) {
    return found.size() == expected.size() &&
           (expected.empty() || std::memcmp(found.data(), expected.data(), expected.size() * sizeof(Pair)) == 0);
}

BroadPhaseOptions bvh_options() {
    BroadPhaseOptions options;
    options.algorithm = "bvh";
    return options;
}

void move(Aabb& box, float x, float y, float z) {
    const float by[3] = {x, y, z};
    for (int d = 0; d < 3; ++d) {
        box.min[d] += by[d];
        box.max[d] += by[d];
    }
}

// Frame after frame: all drift, a few jump, some stop being boxes and come back, all change places, many shrink.
void next_frame(std::vector<Aabb>& boxes, int frame, test::Random& random) {
    const auto step = [&] { return static_cast<float>(random.between(-0.05, 0.05)); };
    const auto jump = [&] { return static_cast<float>(random.between(-40.0, 40.0)); };
    const auto any = [&]() -> Aabb& { return boxes[random.below(boxes.size())]; };
    for (Aabb& box : boxes) move(box, step(), step(), step());
    if (frame % 5 == 1)
        for (int i = 0; i < 3; ++i) move(any(), jump(), jump(), jump());
    if (frame % 5 == 2) any().min[random.below(3)] = std::numeric_limits<float>::quiet_NaN();
    if (frame % 5 == 3)
        for (Aabb& box : boxes)
            if (!test::is_box(box)) box = Aabb{{1, 1, 1}, {2, 2, 2}};
    if (frame == 9) std::reverse(boxes.begin(), boxes.end());
    if (frame == 12)
        for (Aabb& box : boxes) move(box, 1000.0f, 0.0f, -1000.0f);
    if (frame == 14)
        for (Aabb& box : boxes)
            for (int d = 0; d < 3; ++d) box.max[d] = box.min[d] + 0.5f * (box.max[d] - box.min[d]);
}

void check_frames(Context& context, std::size_t n, int frames) {
    const std::uint64_t seed = 91;
    test::Random random(seed);
    BroadPhase kept(context, bvh_options());
    std::vector<Aabb> boxes = scenes::make_boxes("density", n, 4);
    for (int frame = 0; frame < frames; ++frame) {
        INFO("seed " << seed << ", frame " << frame);
        const std::vector<Pair> expected = test::pairs_by_hand(boxes);
        CHECK(same(kept.find(boxes), expected));
        const auto rejected = static_cast<std::size_t>(
            std::count_if(boxes.begin(), boxes.end(), [](const Aabb& box) { return !test::is_box(box); }));
        CHECK(kept.report().rejected.size() == rejected);
        next_frame(boxes, frame, random);
        if (frame == 16) boxes.resize(n / 2);  // another tree altogether
    }
}

}  // namespace

TEST_CASE("bvh: moving boxes give the oracle's bytes in every frame", "[device]") {
    for (std::uint32_t device = 0; device < list_devices().size(); ++device)
        for (const std::uint32_t lanes : {1u, 4u, 8u, 16u}) {
            INFO("device " << device << ", lanes " << lanes);
            Context context = test::with_lanes(device, lanes);
            check_frames(context, 1500, 20);
        }
}

TEST_CASE("bvh: moving boxes, few", "[device][small]") {
    Context context = test::with_lanes(0, 1);
    check_frames(context, 90, 18);
}

TEST_CASE("bvh: a box far larger than the rest, and boxes of every size", "[device]") {
    std::vector<Aabb> boxes = scenes::make_boxes("uniform", 1200, 8);
    boxes[17] = Aabb{{-1e6f, -1e6f, -1e6f}, {1e6f, 1e6f, 1e6f}};
    test::Random random(5);
    for (std::size_t i = 100; i < 400; ++i) {  // twelve decades
        const double side = std::pow(10.0, random.between(-8.0, 4.0));
        for (int d = 0; d < 3; ++d) boxes[i].max[d] = static_cast<float>(static_cast<double>(boxes[i].min[d]) + side);
    }
    const std::vector<Pair> expected = test::pairs_by_hand(boxes);
    CHECK(std::count_if(expected.begin(), expected.end(), [](const Pair& p) { return p.a == 17 || p.b == 17; }) ==
          1199);
    for (std::uint32_t device = 0; device < list_devices().size(); ++device)
        for (const std::uint32_t lanes : {1u, 16u}) {
            Context context = test::with_lanes(device, lanes);
            BroadPhase broad_phase(context, bvh_options());
            CHECK(same(broad_phase.find(boxes), expected));
            CHECK(same(broad_phase.find(boxes), expected));
        }
}

TEST_CASE("bvh: a heap of sand among boulders is not one cell", "[device]") {
    std::vector<Aabb> boxes = scenes::make_boxes("density", 2000, 3);
    test::Random random(6);
    for (std::size_t i = 0; i < 2000; ++i) {
        Aabb grain;
        for (int d = 0; d < 3; ++d) {
            grain.min[d] = static_cast<float>(random.between(3.0, 3.2));
            grain.max[d] = grain.min[d] + 1e-4f;
        }
        boxes.push_back(grain);
    }
    const std::vector<Pair> expected = test::pairs_by_hand(boxes);
    for (const std::uint32_t lanes : {1u, 16u}) {
        Context context = test::with_lanes(0, lanes);
        BroadPhase broad_phase(context, bvh_options());
        for (std::size_t n : {4000u, 3999u, 4000u}) {  // each time another tree
            const View<const Pair> found = broad_phase.find({boxes.data(), n});
            if (n == boxes.size()) CHECK(same(found, expected));
            CHECK(broad_phase.report().box_tests < 1000000);  // grain by grain it would be two millions
        }
    }
}

// Such a device is pretended where there is none: each search is then cut into windows.
TEST_CASE("bvh: where loops end early", "[device]") {
    const std::vector<Aabb> boxes = scenes::make_boxes("clusters", 8000, 3);
    const std::vector<Pair> expected = test::pairs_by_hand(boxes);
    for (const std::uint32_t lanes : {1u, 8u, 16u}) {
        Context context = test::with_lanes(0, lanes);
        context.impl().infos[0].name += " (as llvmpipe)";
        REQUIRE(detail::most_loop_iterations(context.impl().infos[0]) == 65535);
        BroadPhase broad_phase(context, bvh_options());
        CHECK(same(broad_phase.find(boxes), expected));
        CHECK(same(broad_phase.find({boxes.data(), 40}), test::pairs_by_hand({boxes.begin(), boxes.begin() + 40})));
    }
}

TEST_CASE("bvh: the order is kept while it serves", "[device]") {
    Context context = test::with_lanes(0, 8);
    detail::Device& device = context.impl().open(0);
    detail::Buffer staging;
    detail::BvhTree tree(device);
    std::vector<Aabb> boxes = scenes::make_boxes("density", 4000, 4);
    const auto update = [&] {
        detail::BoxInput input(boxes, staging);
        tree.update(input);
        return tree.kept_order();
    };
    CHECK_FALSE(update());
    CHECK(update());
    for (Aabb& box : boxes) move(box, 0.01f, -0.02f, 0.01f);
    CHECK(update());
    CHECK_FALSE(tree.any_invalid());
    boxes[7].max[1] = std::numeric_limits<float>::infinity();
    CHECK(update());
    CHECK(tree.any_invalid());

    // Boxes that change places tear the nodes apart; sorted anew, they serve again.
    for (std::size_t i = 0; i < 200; ++i) std::swap(boxes[i], boxes[i + 2000]);
    CHECK_FALSE(update());
    CHECK(update());

    // More box tests than after the build.
    CHECK_FALSE([&] {
        tree.searched(1000);
        tree.searched(1200);
        const bool kept = update();
        tree.searched(1300);
        return !kept || update();
    }());
    boxes.pop_back();
    CHECK_FALSE(update());
}
