// What "auto" chooses, by what it is told.
#include <catch2/catch.hpp>
#include <limits>
#include <string>
#include <vector>

#include "bench/scenes/boxes.hpp"
#include "clinch/broad_phase.hpp"
#include "src/broad_phase/algorithm.hpp"

using namespace clinch;

namespace {

std::string choice(std::uint64_t count, std::uint64_t last_pairs, View<const Aabb> boxes = {}) {
    const DeviceInfo device;
    return detail::choose_algorithm(count, last_pairs, &device, boxes).name;
}

std::string choice_for(const std::string& kind, std::size_t count) {
    return choice(count, 0, scenes::make_boxes(kind, count, 1));
}

}  // namespace

TEST_CASE("auto: the host for few boxes and where there is no device", "[host]") {
    for (const std::uint64_t count : {0u, 1u, 250u, 1000u, 1000000u})
        CHECK(std::string(detail::choose_algorithm(count, 0, nullptr).name) == "host-sweep");
    for (const std::uint64_t count : {0u, 1u, 250u, 1000u, 2500u}) CHECK(choice(count, 0) == "host-sweep");
    for (const std::uint64_t count : {2501u, 10000u, 4000000u}) CHECK(choice(count, 0) == "bvh");
}

TEST_CASE("auto: many pairs in the last call are no work for the host", "[host]") {
    CHECK(choice(2500, 5000) == "host-sweep");
    CHECK(choice(2500, 200000) == "bvh");
    CHECK(choice(250, 250 * 249 / 2) == "host-sweep");
    CHECK(choice(1000, 1000 * 999 / 2) == "bvh");
}

TEST_CASE("auto: a sample tells which scenes are sparse enough to sweep on the host", "[host]") {
    for (const char* const kind : {"uniform", "density", "mixed", "clusters"}) {
        INFO(kind);
        CHECK(choice_for(kind, 2600) == "host-sweep");
        CHECK(choice_for(kind, 100000) == "bvh");
    }
    CHECK(choice_for("mixed", 10000) == "host-sweep");
    CHECK(choice_for("mixed", 20000) == "host-sweep");
    CHECK(choice_for("density", 30000) == "bvh");
    CHECK(choice_for("line", 15000) == "bvh");
    CHECK(choice_for("grid-touch", 15000) == "bvh");
    CHECK(choice_for("identical", 2600) == "bvh");
}

TEST_CASE("auto: boxes that are none are not in the sample", "[host]") {
    std::vector<Aabb> boxes = scenes::make_boxes("identical", 3000, 1);
    constexpr float infinite = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < boxes.size(); i += 2) boxes[i].max[i % 3] = infinite, boxes[i].min[0] = -infinite;
    CHECK(choice(boxes.size(), 0, boxes) == "bvh");
    for (Aabb& box : boxes) box.min[1] = std::numeric_limits<float>::quiet_NaN();
    CHECK(choice(boxes.size(), 0, boxes) == "host-sweep");
}
