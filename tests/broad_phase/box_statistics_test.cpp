#include "src/broad_phase/box_statistics.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "bench/scenes/boxes.hpp"
#include "tests/device/devices.hpp"

using namespace clinch;

namespace {

detail::BoxStatistics gather(detail::Device& device, const std::vector<Aabb>& boxes) {
    detail::Buffer staging;
    detail::BoxInput input(boxes, staging);
    return detail::StatisticsGatherer(device).gather(input);
}

}  // namespace

TEST_CASE("statistics of boxes: range, widths, and where no box is", "[device][small]") {
    const Context context = test::all_devices();
    for (const auto& device : context.impl().devices) {
        INFO(device->info().name);
        std::vector<Aabb> boxes = scenes::make_boxes("mixed", 3000, 2);
        boxes[17].max[1] = std::nanf("");
        const detail::BoxStatistics found = gather(*device, boxes);
        CHECK(found.boxes == 2999);
        std::uint32_t counted = 0;
        float low = 1e30f, high = -1e30f, widest = 0.0f;
        for (const detail::WidthClass& one : found.widths) {
            counted += one.count;
            CHECK(one.widest > widest);
            widest = one.widest;
        }
        float widest_box = 0.0f;
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            if (i == 17) continue;
            low = std::fmin(low, boxes[i].min[2]);
            high = std::fmax(high, boxes[i].min[2]);
            for (int d = 0; d < 3; ++d) widest_box = std::fmax(widest_box, boxes[i].max[d] - boxes[i].min[d]);
        }
        CHECK(counted == 2999);
        CHECK(found.low[2] == low);
        CHECK(found.high[2] == high);
        CHECK(widest == widest_box);
        CHECK(found.sample.size() >= 250);
    }
}

TEST_CASE("crowding is about 1 for an even spread and large for clusters", "[device][small]") {
    const Context context = test::all_devices();
    for (const auto& device : context.impl().devices) {
        INFO(device->info().name);
        CHECK(gather(*device, scenes::make_boxes("uniform", 4000, 3)).crowding(4.0) < 1.5);
        CHECK(gather(*device, scenes::make_boxes("clusters", 4000, 3)).crowding(4.0) > 10.0);
        CHECK(gather(*device, scenes::make_boxes("identical", 100, 3)).crowding(0.0) == 1.0);
    }
}
