// What is sweep3's own; what all algorithms must do is tested in algorithms_test.cpp.
#include <catch2/catch.hpp>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/scenes/boxes.hpp"
#include "clinch/broad_phase.hpp"
#include "clinch/error.hpp"
#include "tests/broad_phase/oracle.hpp"
#include "tests/device/devices.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

BroadPhaseOptions sweep3_options(std::size_t scratch) {
    BroadPhaseOptions options;
    options.algorithm = "sweep3";
    options.scratch_bytes = scratch;
    return options;
}

void check_pairs(BroadPhase& sweep3, const std::vector<Aabb>& boxes, const std::vector<Pair>& expected) {
    const View<const Pair> found = sweep3.find(boxes);
    CHECK(std::vector<Pair>(found.begin(), found.end()) == expected);
}

std::uint64_t overlaps_of_axes(const std::vector<Aabb>& boxes) {
    std::uint64_t overlaps = 0;
    for (std::size_t a = 0; a < boxes.size(); ++a)
        for (std::size_t b = a + 1; b < boxes.size(); ++b)
            for (int d = 0; d < 3; ++d)
                overlaps += boxes[a].min[d] <= boxes[b].max[d] && boxes[b].min[d] <= boxes[a].max[d] ? 1u : 0u;
    return overlaps;
}

// Few bodies with many bounds in common, of either sign, and some that are no boxes.
std::vector<Aabb> boxes_of_few_bounds(std::size_t n, test::Random& random) {
    const float bounds[] = {-2.0f, -1.0f, -0.0f, 0.0f, 1.0f, 2.0f};
    std::vector<Aabb> boxes(n);
    for (Aabb& box : boxes)
        for (int d = 0; d < 3; ++d) {
            box.min[d] = bounds[random.below(6)];
            box.max[d] = random.below(30) == 0 ? -9.0f : bounds[3 + random.below(3)];
        }
    return boxes;
}

}  // namespace

TEST_CASE("sweep3: equal bounds, zeros of either sign, and what is no box", "[device][small]") {
    test::Random random(91);
    for (std::uint32_t device = 0; device < list_devices().size(); ++device) {
        Context context = test::with_lanes(device, 1);
        BroadPhase sweep3(context, sweep3_options(0));
        for (const std::size_t n : {2u, 3u, 60u}) {
            const std::vector<Aabb> boxes = boxes_of_few_bounds(n, random);
            check_pairs(sweep3, boxes, test::pairs_by_hand(boxes));
        }
    }
}

TEST_CASE("sweep3: every overlap of every axis is looked at once, in one batch or in many", "[device]") {
    std::vector<Aabb> boxes = scenes::make_boxes("uniform", 3000, 11);
    for (std::size_t i = 0; i < boxes.size(); i += 300)  // bodies whose overlaps are very many
        for (int d = 0; d < 3; ++d) boxes[i].min[d] = -100.0f, boxes[i].max[d] = 100.0f;
    const std::vector<Pair> expected = test::pairs_by_hand(boxes);
    const std::uint64_t overlaps = overlaps_of_axes(boxes);
    REQUIRE(overlaps > 600000);
    for (std::uint32_t device = 0; device < list_devices().size(); ++device)
        for (const std::uint32_t lanes : {1u, 16u})
            for (const std::size_t scratch : {std::size_t{1} << 20, std::size_t{3} << 20, std::size_t{1} << 28}) {
                INFO("lanes " << lanes << ", scratch " << scratch);
                Context context = test::with_lanes(device, lanes);
                BroadPhaseOptions options = sweep3_options(scratch);
                int batches = 0;
                options.progress = [&](double) { ++batches; };
                BroadPhase sweep3(context, options);
                check_pairs(sweep3, boxes, expected);
                CHECK(sweep3.report().box_tests == overlaps);
                CHECK((batches == 1) == (scratch == std::size_t{1} << 28));
                check_pairs(sweep3, {boxes.begin(), boxes.begin() + 500},
                            test::pairs_by_hand({boxes.begin(), boxes.begin() + 500}));
            }
}

TEST_CASE("sweep3: a limit passed in an early batch names the count of all", "[device]") {
    const std::vector<Aabb> boxes(600, Aabb{{0, 0, 0}, {1, 1, 1}});
    Context context = test::with_lanes(0, 8);
    BroadPhaseOptions options = sweep3_options(0);
    options.max_pairs = 100;
    BroadPhase sweep3(context, options);
    CHECK_THROWS_WITH(sweep3.find(boxes), Catch::Contains("179700"));
}
