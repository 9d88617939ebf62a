// Sorted lists of keys become one list of pairs, each once.
#include "src/broad_phase/key_merge.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <set>
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

std::vector<Pair> merged(const std::vector<std::set<Pair>>& lists, const KeyLayout& layout) {
    std::vector<Packed> packed;
    for (const auto& list : lists) packed.emplace_back(list, layout);
    std::vector<PairKeys> views;
    for (const Packed& list : packed) views.push_back(list.view());
    PairList out;
    out.append({{7, 7}});  // what is there stays
    merge_keys(views, out);
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
                for (const std::size_t several : {1u, 2u, 3u, 40u}) {
                    INFO(pairs.size() << " pairs in " << lists << " lists, " << layout.buckets << " buckets of "
                                      << layout.shift << " bits, several " << several);
                    const std::vector<Pair> found = merged(deal(pairs, lists, several, random), layout);
                    CHECK(std::equal(found.begin(), found.end(), pairs.begin(), pairs.end()));
                }
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
        merge_keys({{layout, keys[0], starts[0]}, {layout, keys[1], starts[1]}}, out);
        const View<const Pair> found = out.view();
        CHECK(std::equal(found.begin() + before, found.end(), pairs.begin(), pairs.end()));
    }
}
