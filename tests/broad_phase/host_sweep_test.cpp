// What host-sweep keeps between calls decides its time alone: every frame gives what a first call gives.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "bench/scenes/boxes.hpp"
#include "clinch/broad_phase.hpp"
#include "clinch/error.hpp"
#include "tests/broad_phase/oracle.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

BroadPhaseOptions sweep_options(Order order = Order::Sorted) {
    BroadPhaseOptions options;
    options.algorithm = "host-sweep";
    options.order = order;
    return options;
}

std::vector<Pair> found_by(BroadPhase& sweep, const std::vector<Aabb>& boxes) {
    const View<const Pair> found = sweep.find(boxes);
    return {found.begin(), found.end()};
}

void move(Aabb& box, int d, double by) {
    box.min[d] = static_cast<float>(static_cast<double>(box.min[d]) + by);
    box.max[d] = static_cast<float>(static_cast<double>(box.max[d]) + by);
}

// The next frame: most boxes move a little, or all far, or some stop being boxes, or come or go.
void next_frame(std::vector<Aabb>& boxes, test::Random& random) {
    const std::uint64_t what = random.below(6);
    const auto d = static_cast<int>(random.below(3));
    if (what == 0)
        for (Aabb& box : boxes) std::swap(box.min[0], box.min[d]), std::swap(box.max[0], box.max[d]);
    if (what == 1) std::reverse(boxes.begin(), boxes.end());
    if (what == 2 && boxes.size() > 100) boxes.resize(boxes.size() - 1 - random.below(90));
    if (what == 3) boxes.insert(boxes.end(), boxes.begin(), boxes.begin() + 40);
    if (what == 4) boxes[random.below(boxes.size())].min[d] = std::numeric_limits<float>::quiet_NaN();
    for (Aabb& box : boxes)
        if (random.below(10) != 0) move(box, d, random.between(-0.05, 0.05));
}

}  // namespace

TEST_CASE("host-sweep: frames of moving, jumping, coming and going boxes", "[host]") {
    for (const std::uint64_t seed : {81u, 82u, 83u}) {
        test::Random random(seed);
        Context context = Context::host_only();
        BroadPhase kept(context, sweep_options()), any(context, sweep_options(Order::Any));
        std::vector<Aabb> boxes = scenes::make_boxes("uniform", 700, seed);
        for (int frame = 0; frame < 60; ++frame) {
            INFO("seed " << seed << ", frame " << frame);
            const std::vector<Pair> expected = test::pairs_by_hand(boxes);
            CHECK(found_by(kept, boxes) == expected);
            std::vector<Pair> found = found_by(any, boxes);
            std::sort(found.begin(), found.end());
            CHECK(found == expected);
            next_frame(boxes, random);
        }
    }
}

TEST_CASE("host-sweep: frames of other boxes each time, of either sign, both zeros and any size", "[host]") {
    const std::uint64_t seed = 84;
    test::Random random(seed);
    Context context = Context::host_only();
    BroadPhase kept(context, sweep_options());
    constexpr float most = std::numeric_limits<float>::max(), none = std::numeric_limits<float>::quiet_NaN();
    for (const std::size_t count : {60u, 128u, 129u, 300u, 300u, 300u, 300u}) {
        std::vector<Aabb> boxes(count);
        for (Aabb& box : boxes)
            for (int d = 0; d < 3; ++d) {
                const auto at = static_cast<float>(random.between(-4.0, 4.0));
                const std::uint64_t what = random.below(60);
                box.min[d] = what == 0 ? -0.0f : what == 1 ? 0.0f : what == 2 ? -most : what == 3 ? none : at;
                box.max[d] = what == 4 ? most : what < 2 ? 0.0f : at + (what == 5 ? 0.0f : 1.0f);
            }
        INFO("seed " << seed << ", " << count << " boxes");
        const std::vector<Pair> expected = test::pairs_by_hand(boxes);
        CHECK(expected.size() > 20);
        CHECK(found_by(kept, boxes) == expected);
        const auto are_boxes = std::count_if(boxes.begin(), boxes.end(), test::is_box);
        CHECK(kept.report().rejected.size() == count - static_cast<std::size_t>(are_boxes));
    }
}

TEST_CASE("host-sweep: a scene that turns to another axis is soon swept along that one", "[host]") {
    std::vector<Aabb> along_x, along_y;
    for (int i = 0; i < 2000; ++i) {
        const float at = static_cast<float>(i) * 2.0f;
        along_x.push_back({{at, 0, 0}, {at + 1, 1, 1}});
        along_y.push_back({{0, at, 0}, {1, at + 1, 1}});
    }
    Context context = Context::host_only();
    BroadPhase sweep(context, sweep_options());
    CHECK(sweep.find(along_x).empty());
    const std::uint64_t few = sweep.report().box_tests;
    CHECK(sweep.find(along_y).empty());
    CHECK(sweep.report().box_tests == 2000u * 1999u / 2);
    CHECK(sweep.find(along_y).empty());
    CHECK(sweep.report().box_tests == few);
}

TEST_CASE("host-sweep: work for several threads", "[host]") {
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", 20000, 9);
    const std::vector<Pair> expected = test::pairs_by_sweep(boxes);
    REQUIRE(expected.size() > 20000);
    Context context = Context::host_only();
    BroadPhaseOptions options = sweep_options();
    double last = -1.0;
    int until_stop = -1;
    options.progress = [&](double share) {
        CHECK(share >= last);
        last = share;
        if (until_stop-- == 0) throw Error(ErrorCode::InvalidArgument, "stopped");
    };
    BroadPhase sweep(context, options);
    CHECK(found_by(sweep, boxes) == expected);
    last = -1.0;
    until_stop = 0;
    CHECK_THROWS_WITH(sweep.find(boxes), "stopped");
    last = -1.0;
    until_stop = -1;
    CHECK(found_by(sweep, boxes) == expected);
}

TEST_CASE("host-sweep: more pairs than are kept", "[host]") {
    const std::vector<Aabb> boxes(1600, Aabb{{0, 0, 0}, {1, 1, 1}});
    Context context = Context::host_only();
    BroadPhase sweep(context, sweep_options());
    for (int call = 0; call < 2; ++call) {
        const View<const Pair> found = sweep.find(boxes);
        REQUIRE(found.size() == 1600u * 1599u / 2);
        CHECK(std::is_sorted(found.begin(), found.end()));
        CHECK(std::adjacent_find(found.begin(), found.end()) == found.end());
    }
}
