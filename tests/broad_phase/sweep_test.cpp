// What is the sweep's own; what all algorithms must do is tested in algorithms_test.cpp.
#include <catch2/catch.hpp>
#include <limits>
#include <vector>

#include "bench/scenes/boxes.hpp"
#include "clinch/broad_phase.hpp"
#include "src/broad_phase/sweep_axis.hpp"
#include "tests/broad_phase/oracle.hpp"
#include "tests/device/devices.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

Aabb box_at(double x, double y, double z, double side) {
    const auto low = [&](double v) { return static_cast<float>(v); };
    const auto high = [&](double v) { return static_cast<float>(v + side); };
    return {{low(x), low(y), low(z)}, {high(x), high(y), high(z)}};
}

detail::AxisChoice choose(detail::Device& device, const std::vector<Aabb>& boxes) {
    detail::Buffer staging;
    detail::BoxInput input(boxes, staging);
    return detail::AxisChooser(device).choose(input);
}

// Boxes spread most on `axis`, `offset` away from the origin.
std::vector<Aabb> spread_on(int axis, double offset, std::size_t n, test::Random& random) {
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < n; ++i) {
        double at[3];
        for (int d = 0; d < 3; ++d) at[d] = offset + random.between(-1, 1) * (d == axis ? 300 : 100);
        boxes.push_back(box_at(at[0], at[1], at[2], 1.0));
    }
    return boxes;
}

BroadPhaseOptions sweep_options() {
    BroadPhaseOptions options;
    options.algorithm = "sweep";
    return options;
}

void check_pairs(BroadPhase& sweep, const std::vector<Aabb>& boxes, const std::vector<Pair>& expected) {
    const View<const Pair> found = sweep.find(boxes);
    CHECK(std::vector<Pair>(found.begin(), found.end()) == expected);
}

}  // namespace

TEST_CASE("sweep: the axis is that of the largest variance", "[device][small]") {
    constexpr float largest = std::numeric_limits<float>::max(), nan = std::numeric_limits<float>::quiet_NaN();
    test::Random random(71);
    const Context context = test::all_devices();
    for (std::size_t i = 0; i < context.devices().size(); ++i) {
        detail::Device& device = context.impl().open(i);
        for (int axis = 0; axis < 3; ++axis) {
            INFO("axis " << axis);
            const auto wanted = static_cast<std::uint32_t>(axis);
            CHECK(choose(device, spread_on(axis, 0.0, 100, random)).axis == wanted);
            std::vector<Aabb> boxes = spread_on(axis, 1e7, 2500, random);
            boxes[0].min[0] = nan;  // no box, and none that tells where the others are
            boxes[7].max[1] = nan;
            CHECK(choose(device, boxes).axis == wanted);
            CHECK(choose(device, boxes).boxes == 2498);
            // Equal variance (none), or one that float32 cannot hold: the extent decides.
            std::vector<Aabb> nested(20, box_at(-1, -1, -1, 2));
            for (Aabb& box : nested) box.min[axis] = -3.0f, box.max[axis] = 3.0f;
            CHECK(choose(device, nested).axis == wanted);
            for (int d = 0; d < 3; ++d) nested[3].min[d] = d == axis ? -largest : 0.5f * -largest;
            CHECK(choose(device, nested).axis == wanted);
        }
        CHECK(choose(device, std::vector<Aabb>(3, Aabb{{nan, 0, 0}, {1, 1, 1}})).boxes == 0);
    }
}

namespace {

void check_tests(std::uint32_t lanes) {
    std::vector<Aabb> row, heap(90, box_at(5, 5, 5, 1));
    for (int i = 0; i < 90; ++i)
        row.push_back(box_at(2.0 * (89 - i), 0, 0, i % 2 == 0 ? 1 : 2));  // every second touches
    for (std::uint32_t device = 0; device < list_devices().size(); ++device) {
        Context context = test::with_lanes(device, lanes);
        BroadPhase sweep(context, sweep_options());
        CHECK(sweep.find(row).size() == 45);
        CHECK(sweep.report().box_tests == 45);
        CHECK(sweep.find(heap).size() == 90 * 89 / 2);
        CHECK(sweep.report().box_tests == 90 * 89 / 2);
    }
}

}  // namespace

TEST_CASE("sweep: only boxes that meet on the axis are tested", "[device][small]") {
    check_tests(1);
}

TEST_CASE("sweep: only boxes that meet on the axis are tested, in vectors", "[device][vectors]") {
    check_tests(8);
}

TEST_CASE("sweep: ends that touch at zero, from either side and of either sign", "[device][small]") {
    std::vector<Aabb> boxes;
    for (const float zero : {0.0f, -0.0f})
        for (int d = 0; d < 3; ++d) {
            Aabb below{{-1, -1, -1}, {1, 1, 1}}, above = below;
            below.min[d] = -50.0f, below.max[d] = zero;
            above.min[d] = zero, above.max[d] = 50.0f;
            boxes.push_back(below);
            boxes.push_back(above);
        }
    const std::vector<Pair> expected = test::pairs_by_hand(boxes);
    for (std::uint32_t device = 0; device < list_devices().size(); ++device) {
        Context context = test::with_lanes(device, 1);
        BroadPhase sweep(context, sweep_options());
        check_pairs(sweep, boxes, expected);
    }
}

TEST_CASE("sweep: boxes as long as the world beside thousands of small ones, more and fewer in turn", "[device]") {
    test::Random random(72);
    std::vector<Aabb> boxes = scenes::make_boxes("density", 30000, 4);
    for (int i = 0; i < 12; ++i) {  // needles along the world, in the middle of the list
        Aabb& needle = boxes[random.below(boxes.size())];
        for (int d = 0; d < 3; ++d)
            if (d == i % 3) needle.min[d] = -200.0f, needle.max[d] = 200.0f;
    }
    std::vector<Aabb> fewer(boxes.begin(), boxes.begin() + 5001);
    const std::vector<Pair> expected = test::pairs_by_sweep(boxes), expected_fewer = test::pairs_by_sweep(fewer);
    REQUIRE(expected.size() > 29000);
    for (std::uint32_t device = 0; device < list_devices().size(); ++device)
        for (const std::uint32_t lanes : {1u, 16u}) {
            Context context = test::with_lanes(device, lanes);
            BroadPhase sweep(context, sweep_options());
            check_pairs(sweep, boxes, expected);
            check_pairs(sweep, fewer, expected_fewer);
            check_pairs(sweep, boxes, expected);
        }
}
