// Sorted lists of keys become one list of pairs, each once.
#include "src/broad_phase/key_merge.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include "tests/random.hpp"

using namespace clinch;
using namespace clinch::detail;

namespace {

// What a device hands over for sorted pairs.
struct Packed {
    KeyLayout layout;
    std::vector<std::uint32_t> keys, starts;
    Packed(const std::set<Pair>& pairs, const KeyLayout& layout_in) : layout(layout_in) {
        starts.assign(layout.buckets + std::size_t{1}, 0);
        for (const Pair& pair : pairs) {
            keys.push_back((pair.a & ((1u << layout.shift) - 1)) << layout.b_bits | pair.b);
            ++starts[(pair.a >> layout.shift) + 1];
        }
        for (std::size_t k = 1; k < starts.size(); ++k) starts[k] += starts[k - 1];
    }
    PairKeys view() const { return {layout, keys, starts}; }
};

std::vector<Pair> merged(const std::vector<std::set<Pair>>& lists, const KeyLayout& layout, bool disjoint) {
    std::vector<Packed> packed;
    for (const auto& list : lists) packed.emplace_back(list, layout);
    std::vector<PairKeys> views;
    for (const Packed& list : packed) views.push_back(list.view());
    PairList out;
    out.append({{7, 7}});  // what is there stays
    merge_keys(views, disjoint, out);
    const View<const Pair> pairs = out.view();
    REQUIRE(pairs[0] == Pair{7, 7});
    return {pairs.begin() + 1, pairs.end()};
}

// Each pair to one list or to several.
std::vector<std::set<Pair>> deal(const std::set<Pair>& pairs, std::size_t count, std::size_t several,
                                 test::Random& random) {
    std::vector<std::set<Pair>> lists(count);
    for (const Pair& pair : pairs) {
        // Boxes in turn belong to one list, for rows that alternate, or each pair does.
        const std::size_t one =
            several % 2 == 0 ? std::uint64_t{pair.a} * 2654435761u / 64 % count : random.below(count);
        lists[one].insert(lists[one].end(), pair);
        while (random.below(several + 1) == 0) {
            std::set<Pair>& other = lists[random.below(count)];
            other.insert(other.end(), pair);
        }
    }
    return lists;
}

using Run = std::vector<std::uint32_t>;

// Two lists of one bucket become one, in either order; where they have no key in common, also as such.
void check_union(const Run& one, const Run& other) {
    constexpr KeyLayout layout{1, 12, 20};
    const auto count = [](const Run& run) { return static_cast<std::uint32_t>(run.size()); };
    const Run one_starts{0, count(one)}, other_starts{0, count(other)};
    const PairKeys p{layout, one, one_starts}, q{layout, other, other_starts};
    Run keys;
    std::set_union(one.begin(), one.end(), other.begin(), other.end(), std::back_inserter(keys));
    std::vector<Pair> expected;
    for (const std::uint32_t key : keys) expected.push_back({key >> layout.b_bits, key & 0xfffffu});
    const bool disjoint = keys.size() == one.size() + other.size();
    for (const auto& lists : {std::vector<PairKeys>{p, q}, {q, p}, {p, q, p}})
        for (const bool as_such : {false, true}) {
            if (as_such && (!disjoint || lists.size() > 2)) continue;
            for (const std::size_t before : {0u, 1u}) {  // pairs that begin on a multiple of 16 bytes, or not
                PairList out;
                if (before == 1) out.append({{0, 0}});
                merge_keys(lists, as_such, out);
                const View<const Pair> found = out.view();
                CHECK(std::equal(found.begin() + before, found.end(), expected.begin(), expected.end()));
            }
        }
}

// Keys of the one run and of the other take turns of `turn`; every `common`th of the other is one of the first, too (0:
// none).
std::pair<Run, Run> in_turns(std::size_t keys, std::uint32_t turn, std::uint32_t common) {
    std::pair<Run, Run> runs;
    for (std::uint32_t k = 0; runs.first.size() + runs.second.size() < keys; ++k) {
        const bool is_first = k / turn % 2 == 0;
        (is_first ? runs.first : runs.second).push_back(k * 977);
        if (!is_first && common != 0 && k % common == 0) runs.first.push_back(k * 977);
    }
    return runs;
}

}  // namespace

TEST_CASE("lists of keys, with pairs that several of them have, become one", "[host]") {
    const std::uint64_t seed = 71;
    INFO("seed " << seed);
    test::Random random(seed);
    for (const std::size_t lists : {1u, 2u, 3u, 5u, 6u, 7u, 11u})
        for (const std::size_t count : {0u, 1u, 2u, 40u, 1000u, 60000u})
            for (const KeyLayout& layout : {KeyLayout{1, 0, 1}, KeyLayout{8, 7, 10}, KeyLayout{700, 4, 14},
                                            KeyLayout{3, 15, 17}, KeyLayout{4096, 0, 12}, KeyLayout{2048, 10, 21}}) {
                const std::uint64_t rows = random.below(2) == 0 ? 1 + count / 40 : 1 + count * 2;  // long or short
                const std::uint64_t bodies = std::uint64_t{layout.buckets} << layout.shift;
                std::set<Pair> pairs;
                const std::uint64_t first = random.below(bodies);
                for (std::size_t i = 0; i < count; ++i)
                    pairs.insert({static_cast<std::uint32_t>((first + random.below(rows)) % bodies),
                                  static_cast<std::uint32_t>(random.below(std::uint64_t{1} << layout.b_bits))});
                for (const std::size_t several : {1u, 2u, 3u, 40u, 4000000u, 4000001u}) {
                    INFO(pairs.size() << " pairs in " << lists << " lists, " << layout.buckets << " buckets of "
                                      << layout.shift << " bits, several " << several);
                    const std::vector<std::set<Pair>> dealt = deal(pairs, lists, several, random);
                    std::size_t all = 0;
                    for (const std::set<Pair>& list : dealt) all += list.size();
                    for (const bool disjoint : {false, true}) {
                        if (disjoint && all > pairs.size()) continue;
                        const std::vector<Pair> found = merged(dealt, layout, disjoint);
                        CHECK(std::equal(found.begin(), found.end(), pairs.begin(), pairs.end()));
                    }
                }
            }
}

TEST_CASE("two runs become one however they lie and however long they are", "[host]") {
    const std::uint64_t seed = 72;
    INFO("seed " << seed);
    test::Random random(seed);
    const auto run_of = [&random](std::size_t size, std::uint64_t first, std::uint64_t range) {
        std::set<std::uint32_t> keys;
        while (keys.size() < size) keys.insert(static_cast<std::uint32_t>(first + random.below(range)));
        return Run(keys.begin(), keys.end());
    };
    constexpr std::uint64_t all = std::uint64_t{1} << 32;
    // About the lengths from which on runs are looked at, cut, and not quite full.
    const std::vector<std::size_t> sizes{0, 1, 7, 8, 9, 31, 32, 33, 255, 256, 257, 319, 320, 321, 383, 500, 1023, 4099};
    for (const std::size_t p : sizes)
        for (const std::size_t q : sizes) {
            if (q > p) continue;
            INFO(p << " and " << q << " keys");
            check_union(run_of(p, 0, all), run_of(q, 0, all));
            check_union(run_of(p, 0, 2 * p + 1), run_of(q, 0, 2 * p + 1));             // many are common
            check_union(run_of(p, all - p, p), run_of(q, all - p, p));                 // all are: the highest
            check_union(run_of(p, 0, all / 2), run_of(q, all / 2, all / 2));           // one before the other
            check_union(run_of(p, 0, all), run_of(q, all / 3, q + std::uint64_t{1}));  // within a gap of the other
        }
    for (const std::uint32_t turn : {1u, 2u, 5u, 7u, 8u, 9u, 23u, 100u, 3000u})
        for (const std::uint32_t common : {0u, 2u, 30u, 1000000u})
            for (const std::size_t keys : {511u, 640u, 1000u, 9000u}) {
                INFO(keys << " keys in turns of " << turn << ", one of " << common << " common");
                const auto [one, other] = in_turns(keys, turn, common);
                check_union(one, other);
            }
    // At first key by key, then in long blocks, and the other way round.
    auto [one, other] = in_turns(4000, 1, 30);
    const auto [one_blocks, other_blocks] = in_turns(4000, 50, 30);
    for (const bool blocks_first : {false, true}) {
        Run p = blocks_first ? one_blocks : one, q = blocks_first ? other_blocks : other;
        for (const std::uint32_t key : blocks_first ? one : one_blocks) p.push_back(key + 8000 * 977);
        for (const std::uint32_t key : blocks_first ? other : other_blocks) q.push_back(key + 8000 * 977);
        check_union(p, q);
    }
}

TEST_CASE("keys of many more pairs than caches hold become one list", "[host]") {
    const KeyLayout layout{250, 12, 20};
    std::vector<Pair> pairs;
    std::vector<std::uint32_t> keys[2], starts[2];
    for (std::uint32_t a = 0; a < 250u << 12; ++a) {  // of three boxes two are in one list each, and one in both
        if (a % 4096 == 0)
            for (int s = 0; s < 2; ++s) starts[s].push_back(static_cast<std::uint32_t>(keys[s].size()));
        for (std::uint32_t b = a + 1; b < a + 1 + a % 6; ++b) {
            pairs.push_back({a, b});
            for (std::uint32_t s = 0; s < 2; ++s)
                if (a % 3 != s) keys[s].push_back((a % 4096) << 20 | b);
        }
    }
    for (int s = 0; s < 2; ++s) starts[s].push_back(static_cast<std::uint32_t>(keys[s].size()));
    REQUIRE(keys[0].size() + keys[1].size() > 3000000);
    for (const std::size_t before : {0u, 1u}) {  // pairs that begin on a multiple of 16 bytes, and those that do not
        PairList out;
        if (before == 1) out.append({{0, 0}});
        merge_keys({{layout, keys[0], starts[0]}, {layout, keys[1], starts[1]}}, false, out);
        const View<const Pair> found = out.view();
        CHECK(std::equal(found.begin() + before, found.end(), pairs.begin(), pairs.end()));
    }
}
