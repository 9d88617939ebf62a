// What one slab's device hands over.
#include "src/broad_phase/slab_worker.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>

#include "bench/scenes/boxes.hpp"
#include "src/primitives/pair_sort.hpp"
#include "tests/broad_phase/oracle.hpp"
#include "tests/device/devices.hpp"

using namespace clinch;
using namespace clinch::detail;

namespace {

struct Case {
    bool asked, filtered, pieces;  // pieces: one buffer does not hold all pairs
    Order order;
};

// Two slabs' lists from device `i`, and what they become.
void check_case(std::uint32_t i, const std::vector<Aabb>& boxes, const std::vector<Pair>& expected, const Case& c) {
    Context context = test::with_lanes(i, 8);
    if (c.pieces) context.impl().infos[0].max_allocation = 300000;
    const DeviceInfo& info = context.devices()[0];
    const auto layout = PairSort::layout_for(expected.size(), static_cast<std::uint32_t>(boxes.size()), info);
    REQUIRE(layout);
    SlabDeal deal;
    deal.deal(boxes, choose_slabs(boxes, {0.5, 0.5}));
    BroadPhaseOptions options;
    options.order = c.order;
    const std::vector<std::uint32_t> groups(boxes.size(), 1);
    FilterInput filters;
    if (c.filtered) filters.columns.group = groups.data();
    SlabWorker workers[2] = {{context.impl(), options}, {context.impl(), options}};
    const SlabTask task{algorithm_named("bvh"), boxes, filters, deal, false, c.asked ? layout : std::nullopt};
    const bool sorted = c.order == Order::Sorted;
    for (int call = 0; call < 2; ++call) {
        SlabLists lists;
        std::uint64_t found = 0;
        bool in_range = true;
        for (std::size_t s = 0; s < 2; ++s) {
            workers[s].find(task, s);
            lists.push_back(workers[s].pairs());
            CHECK(lists[s].keys.any() == (c.asked && !c.filtered && !c.pieces && sorted && PairSort::packs_on(info) &&
                                          workers[s].found() > 0));
            CHECK(lists[s].named == !c.filtered);
            CHECK(lists[s].keys.size() + lists[s].pairs.size() == workers[s].found());
            found += workers[s].found();
            in_range = in_range && lists[s].in_range;
        }
        CHECK(in_range);
        CHECK(found == expected.size());  // each pair once
        PairList list;
        merge_slabs(deal, lists, sorted, list);
        std::vector<Pair> pairs(list.view().begin(), list.view().end());
        if (!sorted) std::sort(pairs.begin(), pairs.end());
        CHECK(pairs == expected);
    }
}

}  // namespace

TEST_CASE("sorted names of boxes come as keys where they were asked for", "[device]") {
    for (const char* const kind : {"uniform", "identical"}) {
        const std::vector<Aabb> boxes = scenes::make_boxes(kind, 600, 17);
        const std::vector<Pair> expected = test::pairs_by_hand(boxes);
        for (std::uint32_t i = 0; i < list_devices().size(); ++i)
            for (const bool asked : {true, false})
                for (const bool filtered : {false, true})
                    for (const Order order : {Order::Sorted, Order::Any}) {
                        if (!asked && filtered) continue;
                        const bool pieces = expected.size() > 100000;
                        INFO(kind << " on device " << i << ", asked " << asked << ", filtered " << filtered
                                  << ", sorted " << (order == Order::Sorted) << ", pieces " << pieces);
                        check_case(i, boxes, expected, {asked, filtered, pieces, order});
                        if (pieces) check_case(i, boxes, expected, {asked, filtered, false, order});
                    }
    }
}
