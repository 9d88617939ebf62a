#include "src/broad_phase/kept_list.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include "clinch/broad_phase.hpp"
#include "tests/device/devices.hpp"
#include "tests/pair_lists.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

constexpr std::uint32_t bodies = 1000;

// A pair of bodies from `first` on.
Pair random_pair(test::Random& random, std::uint32_t first) {
    const auto a = first + static_cast<std::uint32_t>(random.below(bodies - first - 1));
    return {a, a + 1 + static_cast<std::uint32_t>(random.below(bodies - a - 1))};
}

struct Edits {
    std::vector<Pair> added, removed;
};

// Takes `removed` pairs of the list, spread over all of it, and adds others, from body `first` on.
Edits random_edits(const std::vector<Pair>& list, std::size_t added, std::size_t removed, std::uint32_t first,
                   test::Random& random) {
    const std::set<Pair> there(list.begin(), list.end());
    std::set<Pair> to_add, to_remove;
    while (to_add.size() < added)
        if (const Pair pair = random_pair(random, first); there.count(pair) == 0) to_add.insert(pair);
    while (to_remove.size() < std::min(removed, list.size())) to_remove.insert(list[random.below(list.size())]);
    return {{to_add.begin(), to_add.end()}, {to_remove.begin(), to_remove.end()}};
}

class Lists {
public:
    // `ascending` pairs, told as they are or from the last to the first.
    Lists(detail::Device& device, std::vector<Pair> ascending, bool sorted)
        : kept_(device), expected_(std::move(ascending)) {
        const std::vector<Pair> turned(expected_.rbegin(), expected_.rend());
        kept_.begin(sorted ? expected_ : turned, bodies, sorted);
        check();
    }
    void edit(const Edits& edits) {
        std::vector<Pair> rest = test::without(expected_, edits.removed);
        expected_.clear();
        std::merge(rest.begin(), rest.end(), edits.added.begin(), edits.added.end(), std::back_inserter(expected_));
        kept_.make_room(edits.added.size(), edits.removed.size());
        kept_.edit(edits.added, edits.removed);
        check();
    }
    const std::vector<Pair>& pairs() const { return expected_; }

private:
    void check() {
        REQUIRE(kept_.size() == expected_.size());
        const detail::Mapping mapping = kept_.map();
        CHECK((expected_.empty() || std::equal(expected_.begin(), expected_.end(), mapping.as<Pair>())));
    }
    detail::KeptList kept_;
    std::vector<Pair> expected_;
};

void check_lists(detail::Device& device, std::size_t size, bool sorted, test::Random& random) {
    INFO("size " << size);
    std::set<Pair> pairs;
    while (pairs.size() < size) pairs.insert(random_pair(random, 0));
    Lists lists(device, {pairs.begin(), pairs.end()}, sorted);
    lists.edit({});
    lists.edit(random_edits(lists.pairs(), 1, 0, 0, random));
    lists.edit(random_edits(lists.pairs(), 0, 1, 0, random));
    lists.edit(random_edits(lists.pairs(), 20, 30, 0, random));
    lists.edit(random_edits(lists.pairs(), 40, 10, 700, random));     // only towards the end
    lists.edit(random_edits(lists.pairs(), size / 4, 0, 0, random));  // all shift to one side, far
    lists.edit(random_edits(lists.pairs(), 0, size / 2, 0, random));
    lists.edit(random_edits(lists.pairs(), size / 2, size / 2, 0, random));
    lists.edit({{}, lists.pairs()});
    lists.edit(random_edits(lists.pairs(), 3 * size, 0, 0, random));  // and it grows
}

}  // namespace

TEST_CASE("a kept list is what its edits make of it", "[device]") {
    test::Random random(21);
    for (std::uint32_t i = 0; i < list_devices().size(); ++i) {
        if (!detail::runs_on(detail::algorithm_named("grid"), list_devices()[i])) continue;
        for (const std::uint32_t lanes : {1u, 4u, 8u, 16u}) {
            const Context context = test::with_lanes(i, lanes);
            INFO("device " << i << " lanes " << lanes);
            for (const std::size_t size : {0u, 1u, 15u, 600u, 33000u})
                check_lists(context.impl().open(0), size, size < 33000, random);
        }
    }
}

TEST_CASE("a short kept list", "[device][vectors]") {
    test::Random random(22);
    for (std::uint32_t i = 0; i < list_devices().size(); ++i) {
        if (!detail::runs_on(detail::algorithm_named("grid"), list_devices()[i])) continue;
        const Context context = test::with_lanes(i, 1);
        check_lists(context.impl().open(0), 1500, true, random);
    }
}

TEST_CASE("a short kept list, copied by vectors", "[device][vectors]") {
    test::Random random(23);
    for (std::uint32_t i = 0; i < list_devices().size(); ++i) {
        if (!detail::runs_on(detail::algorithm_named("grid"), list_devices()[i])) continue;
        const Context context = test::with_lanes(i, 8);
        check_lists(context.impl().open(0), 1000, false, random);
    }
}
