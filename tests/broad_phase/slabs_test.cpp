// Cuts through space: each pair belongs to one slab, where both of its boxes are; lists of slabs become one.
#include "src/broad_phase/slabs.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>

#include "bench/scenes/boxes.hpp"
#include "src/broad_phase/slab_merge.hpp"
#include "tests/broad_phase/oracle.hpp"
#include "tests/random.hpp"

using namespace clinch;
using namespace clinch::detail;

namespace {

std::vector<double> random_fractions(std::size_t count, test::Random& random) {
    std::vector<double> fractions;
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        fractions.push_back(random.below(6) == 0 ? 0.0 : random.between(0.01, 1.0));
        sum += fractions.back();
    }
    if (sum == 0.0) fractions[0] = sum = 1.0;
    for (double& fraction : fractions) fraction /= sum;
    return fractions;
}

// Pairs among the members of a slab, as an algorithm finds them: numbered by their places.
std::vector<Pair> pairs_in(const std::vector<Aabb>& boxes, const std::vector<std::uint32_t>& members) {
    std::vector<Aabb> own;
    for (const std::uint32_t i : members) own.push_back(boxes[i]);
    return test::pairs_by_hand(own);
}

// How the list of a slab is handed over: pairs of places, of names, or those as keys.
enum class As { Places, Names, Keys };

std::vector<Pair> merged(const SlabDeal& deal, std::vector<std::vector<Pair>> found, bool sorted,
                         const std::vector<As>& as = {}) {
    constexpr KeyLayout layout{600, 6, 16};
    SlabLists lists;
    std::vector<std::vector<std::uint32_t>> keys(found.size()), starts(found.size());
    for (std::size_t s = 0; s < found.size(); ++s) {
        const As this_as = s < as.size() ? as[s] : As::Places;
        if (this_as != As::Places)
            for (Pair& pair : found[s]) pair = {deal.members(s)[pair.a], deal.members(s)[pair.b]};
        if (this_as != As::Keys) {
            lists.push_back({found[s], this_as == As::Names, false, {}});
            continue;
        }
        for (std::uint32_t bucket = 0; bucket <= layout.buckets; ++bucket)
            starts[s].push_back(static_cast<std::uint32_t>(
                std::lower_bound(found[s].begin(), found[s].end(), Pair{bucket << layout.shift, 0}) -
                found[s].begin()));
        for (const Pair& pair : found[s]) keys[s].push_back((pair.a & 63u) << layout.b_bits | pair.b);
        lists.push_back({{}, true, false, {layout, keys[s], starts[s]}});
    }
    PairList list;
    merge_slabs(deal, lists, sorted, list);
    const View<const Pair> pairs = list.view();
    return {pairs.begin(), pairs.end()};
}

}  // namespace

TEST_CASE("lists of slabs become the list of all boxes, each pair once", "[host]") {
    const std::uint64_t seed = 51;
    INFO("seed " << seed);
    test::Random random(seed);
    for (const scenes::BoxKind& kind : scenes::box_kinds())
        for (int round = 0; round < 4; ++round) {
            const std::size_t n = 2 + random.below(kind.all_pairs ? 60 : 1500), count = 1 + random.below(7);
            const std::vector<Aabb> boxes = scenes::make_boxes(kind.name, n, random.below(100));
            const Slabs slabs = choose_slabs(boxes, random_fractions(count, random));
            INFO(kind.name << ", " << n << " boxes, " << count << " slabs across axis " << slabs.axis);
            REQUIRE(slabs.count() == count);
            CHECK(std::is_sorted(slabs.cuts.begin(), slabs.cuts.end()));
            SlabDeal deal;
            deal.deal(boxes, slabs);
            std::vector<std::vector<Pair>> found;
            for (std::size_t s = 0; s < count; ++s) {
                CHECK(std::is_sorted(deal.members(s).begin(), deal.members(s).end()));
                found.push_back(pairs_in(boxes, deal.members(s)));
            }
            const std::vector<Pair> expected = test::pairs_by_hand(boxes);
            std::vector<As> as, named, any_as;
            for (std::size_t s = 0; s < count; ++s) {
                as.push_back(random.below(2) == 0 ? As::Places : As::Names);
                named.push_back(random.below(2) == 0 ? As::Names : As::Keys);
                any_as.push_back(static_cast<As>(random.below(3)));
            }
            CHECK(merged(deal, found, true) == expected);
            for (const std::vector<As>& each :
                 {as, named, any_as, std::vector<As>(count, As::Names), std::vector<As>(count, As::Keys)})
                CHECK(merged(deal, found, true, each) == expected);
            for (std::vector<Pair>& list : found)
                for (std::size_t i = list.size(); i > 1; --i) std::swap(list[i - 1], list[random.below(i)]);
            std::vector<Pair> any = merged(deal, found, false);
            std::sort(any.begin(), any.end());
            CHECK(any == expected);
            any = merged(deal, found, false, as);
            std::sort(any.begin(), any.end());
            CHECK(any == expected);
        }
}

TEST_CASE("members stay while boxes move a little, and the list is right", "[host]") {
    const std::uint64_t seed = 52;
    INFO("seed " << seed);
    test::Random random(seed);
    int kept = 0, dealt = 0;
    for (int round = 0; round < 12; ++round) {
        std::vector<Aabb> boxes = scenes::make_boxes(round % 2 == 0 ? "cubes" : "density", 900, random.below(100));
        SlabDeal deal;
        CHECK_FALSE(deal.keep(boxes));
        deal.deal(boxes, choose_slabs(boxes, {0.3, 0.3, 0.4}));
        for (int step = 0; step < 8; ++step) {
            for (Aabb& box : boxes)
                for (int d = 0; d < 3; ++d) {
                    const auto way = static_cast<float>(random.between(-0.12, 0.12));
                    box.min[d] += way;
                    box.max[d] += way;
                }
            const std::vector<std::uint32_t> before = deal.members(1);
            std::vector<Aabb> rows[2] = {std::vector<Aabb>(before.size()),
                                         std::vector<Aabb>(deal.members(2).size())};  // of slabs 1 and 2
            SlabDeal without_spans = deal;
            const bool looked = without_spans.keep(boxes, {}, false);
            const bool keeps =
                step % 2 == 0 ? deal.keep(boxes) : deal.keep(boxes, {nullptr, rows[0].data(), rows[1].data()});
            CHECK(looked == keeps);
            if (keeps) {
                for (std::size_t s = 1; s < 3 && step % 2 == 1; ++s)
                    for (std::size_t i = 0; i < deal.members(s).size(); ++i)
                        REQUIRE(std::memcmp(&rows[s - 1][i], &boxes[deal.members(s)[i]], sizeof(Aabb)) == 0);
                CHECK(deal.members(1) == before);
                ++kept;
            } else {
                deal.deal(boxes, deal.slabs());
                ++dealt;
            }
            std::vector<std::vector<Pair>> found;
            for (std::size_t s = 0; s < deal.count(); ++s) found.push_back(pairs_in(boxes, deal.members(s)));
            CHECK(merged(deal, found, true) == test::pairs_by_hand(boxes));
        }
        boxes.pop_back();
        CHECK_FALSE(deal.keep(boxes));
    }
    CHECK(kept > 5);
    CHECK(dealt > 10);
}

TEST_CASE("many pairs are merged in many parts", "[host]") {
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", 30000, 4);
    SlabDeal deal;
    deal.deal(boxes, choose_slabs(boxes, {0.4, 0.1, 0.5}));
    std::vector<std::vector<Pair>> found;
    for (std::size_t s = 0; s < deal.count(); ++s) {
        std::vector<Aabb> own;
        for (const std::uint32_t i : deal.members(s)) own.push_back(boxes[i]);
        found.push_back(test::pairs_by_sweep(own));
    }
    const std::vector<Pair> expected = test::pairs_by_sweep(boxes);
    REQUIRE(expected.size() > 70000);
    CHECK(merged(deal, found, true) == expected);
    for (const As as : {As::Names, As::Keys}) CHECK(merged(deal, found, true, std::vector<As>(3, as)) == expected);
    CHECK(merged(deal, found, true, {As::Keys, As::Names, As::Keys}) == expected);
    std::vector<Pair> any = merged(deal, found, false);
    std::sort(any.begin(), any.end());
    CHECK(any == expected);
}

TEST_CASE("slabs hold the share of boxes that was asked for, across the axis that fewest reach over", "[host]") {
    std::vector<Aabb> boxes;
    test::Random random(7);
    for (int i = 0; i < 20000; ++i) {  // long on x and z
        const auto at = [&] { return static_cast<float>(random.between(0.0, 100.0)); };
        const float x = at(), y = at(), z = at();
        boxes.push_back({{x, y, z}, {x + 60.0f, y + 0.01f, z + 30.0f}});
    }
    const std::vector<double> fractions{0.1, 0.6, 0.3};
    const Slabs slabs = choose_slabs(boxes, fractions);
    CHECK(slabs.axis == 1);
    CHECK(slabs.copies < 0.01);
    SlabDeal deal;
    deal.deal(boxes, slabs);
    for (std::size_t s = 0; s < 3; ++s)
        CHECK(static_cast<double>(deal.members(s).size()) / 20000.0 == Approx(fractions[s]).margin(0.03));
}

TEST_CASE("shares are as exact as the sample by which they are cut", "[host]") {
    const std::uint64_t seed = 53;
    INFO("seed " << seed);
    constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    constexpr double sample = 65536.0, deviations = 4.0;
    test::Random random(seed);
    for (const std::size_t n : {40000u, 65536u, 65537u, 300000u}) {
        std::vector<Aabb> boxes;
        std::size_t invalid = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const auto at = [&] { return static_cast<float>(random.between(0.0, 100.0)); };
            const float x = at(), y = at(), z = at();
            boxes.push_back({{x, y, z}, {x + 0.01f, y + 1.0f, z + 1.0f}});
            if (i % 50 != 7) continue;
            boxes.back().min[invalid % 3] = invalid % 2 == 0 ? nan : inf;
            ++invalid;
        }
        for (const std::vector<double>& fractions : std::vector<std::vector<double>>{
                 {0.5, 0.5},
                 {0.9, 0.1},
                 {1.0, 0.0},
                 {0.0, 1.0},
                 {0.2, 0.3, 0.5},
                 {0.25, 0.0, 0.75},
                 {0.2, 0.1, 0.05, 0.15, 0.2, 0.2, 0.1},
                 std::vector<double>(7, 1.0 / 7.0),
                 std::vector<double>(Slabs::most, 1.0 / static_cast<double>(Slabs::most))}) {
            const Slabs slabs = choose_slabs(boxes, fractions);
            INFO(n << " boxes, " << fractions.size() << " slabs");
            REQUIRE(slabs.count() == fractions.size());
            CHECK(slabs.axis == 0);
            CHECK(std::is_sorted(slabs.cuts.begin(), slabs.cuts.end()));
            std::vector<std::size_t> begin_in(fractions.size(), 0);
            for (std::size_t i = 0; i < n; ++i)
                if (i % 50 != 7) ++begin_in[slabs.span_of(boxes[i]).first];
            for (std::size_t s = 0; s < fractions.size(); ++s) {
                const double share = static_cast<double>(begin_in[s]) / static_cast<double>(n - invalid);
                // A few boxes begin at the same place; a sample of all is exact.
                const double deviation = n <= 65536 ? 0.0 : std::sqrt(fractions[s] * (1.0 - fractions[s]) / sample);
                CHECK(share == Approx(fractions[s]).margin(deviations * deviation + 2e-4));
            }
        }
    }
}

TEST_CASE("what is no box is met in one slab at least, and boxes without end in all", "[host]") {
    constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<Aabb> boxes = scenes::make_boxes("uniform", 100, 2);
    boxes.insert(boxes.end(),
                 {{{nan, nan, nan}, {nan, nan, nan}}, {{9, 9, 9}, {1, 1, 1}}, {{-inf, -inf, -inf}, {inf, inf, inf}}});
    SlabDeal deal;
    deal.deal(boxes, choose_slabs(boxes, {0.25, 0.25, 0.5}));
    std::vector<int> met(boxes.size(), 0);
    for (std::size_t s = 0; s < deal.count(); ++s)
        for (const std::uint32_t i : deal.members(s)) ++met[i];
    CHECK(*std::min_element(met.begin(), met.end()) == 1);
    CHECK(met[102] == 3);
    const std::vector<Aabb> none(10, boxes[100]);
    CHECK(choose_slabs(none, {0.5, 0.5}).count() == 2);
    deal.deal({}, choose_slabs({}, {0.5, 0.5}));
    CHECK(deal.boxes() == 0);
    CHECK(merged(deal, {{}, {}}, true).empty());
}

TEST_CASE("no cut is what a device may take for another number", "[host]") {
    const std::vector<float> places{0.0f, -0.0f, 1e-40f, -1e-40f, 1e-45f};
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < 1000; ++i) {
        const float at = places[i % places.size()];
        boxes.push_back({{at, at, at}, {at, at, at}});
    }
    const Slabs slabs = choose_slabs(boxes, {0.3, 0.3, 0.4});
    for (const float cut : slabs.cuts) CHECK(std::fabs(cut) >= std::numeric_limits<float>::min());
    CHECK(slabs.low(0) < -1e38f);
    CHECK(slabs.high(0) == slabs.low(1));
    CHECK(slabs.high(2) > 1e38f);
}
