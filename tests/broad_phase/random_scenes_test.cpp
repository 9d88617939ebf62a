// Scenes of every kind, of random sizes and large, on every algorithm of the registry, against the oracles.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "bench/scenes/boxes.hpp"
#include "clinch/broad_phase.hpp"
#include "tests/broad_phase/every_algorithm.hpp"
#include "tests/broad_phase/oracle.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

constexpr std::size_t scene_count = 200;

// Takes a time that grows much faster than boxes and pairs, so that it gets fewer boxes.
bool slow(const std::string& algorithm) {
    return algorithm == "host-brute" || algorithm == "sweep3";
}

// One scene, and who is to find its pairs.
struct Trial {
    test::Setting setting;
    std::string kind;
    std::size_t boxes;
    std::uint64_t seed;
    bool filtered;
    BroadPhaseOptions options;
};

// Mostly 2 to 3,000 boxes, half of them rather few; one in twenty up to 10,000. Where all are pairs, or the
// algorithm is slow, fewer.
std::size_t random_size(bool all_pairs, bool is_slow, test::Random& random) {
    std::size_t most = 3000;
    if (random.below(20) == 0) most = 10000;
    if (random.below(2) == 0) most = 1 + random.below(most);
    if (is_slow) most = std::min<std::size_t>(most, 1200);
    if (all_pairs) most = std::min<std::size_t>(most, 300);
    return 2 + random.below(most);
}

// The trials go through all algorithms on all devices, and those through all kinds, so that each of them gets its
// share; the rest is random.
std::vector<Trial> random_trials(test::Random& random) {
    std::map<std::pair<std::uint32_t, std::string>, std::vector<test::Setting>> rows;
    for (const test::Setting& setting : test::settings(test::all_lanes))
        rows[{setting.device, setting.name}].push_back(setting);
    const std::vector<scenes::BoxKind> kinds = scenes::box_kinds();
    std::vector<Trial> trials;
    for (std::size_t i = 0; i < scene_count; ++i) {
        const std::vector<test::Setting>& row = std::next(rows.begin(), static_cast<long>(i % rows.size()))->second;
        const scenes::BoxKind& kind = kinds[i / rows.size() % kinds.size()];
        Trial trial;
        trial.setting = row[random.below(row.size())];
        trial.kind = kind.name;
        trial.boxes = random_size(kind.all_pairs, slow(trial.setting.name), random);
        trial.seed = random.below(1000);
        trial.filtered = random.below(2) == 0;
        trial.options.algorithm = trial.setting.name;
        trial.options.order = random.below(3) == 0 ? Order::Any : Order::Sorted;
        if (random.below(3) == 0) trial.options.scratch_bytes = 200000;  // several batches, several fills
        trials.push_back(trial);
    }
    return trials;
}

void check_trial(const Trial& trial, std::uint64_t filter_seed) {
    test::Random random(filter_seed);
    const std::vector<Aabb> boxes = scenes::make_boxes(trial.kind, trial.boxes, trial.seed);
    const test::Filters filters = test::random_filters(trial.filtered ? boxes.size() : 0, random);
    const FilterColumns columns = trial.filtered ? filters.columns() : FilterColumns{};
    const std::vector<Pair> expected =
        boxes.size() > 3000 ? test::pairs_by_sweep(boxes, columns) : test::pairs_by_hand(boxes, columns);

    Context context = test::with_lanes(trial.setting.device, trial.setting.lanes);
    BroadPhase broad_phase(context, trial.options);
    const View<const Pair> found = broad_phase.find(boxes, columns);
    if (trial.options.order == Order::Any) {
        std::vector<Pair> sorted(found.begin(), found.end());
        std::sort(sorted.begin(), sorted.end());
        CHECK(test::same(sorted, expected));
    } else {
        CHECK(test::same(found, expected));
    }
    CHECK(broad_phase.report().algorithm == trial.setting.name);
    CHECK(broad_phase.report().rejected.empty());
    CHECK(broad_phase.count(boxes, columns) == expected.size());
}

}  // namespace

TEST_CASE("200 random scenes of random kinds and sizes give the oracle's bytes", "[device]") {
    const std::uint64_t seed = 20110915;
    INFO("seed " << seed);
    test::Random random(seed);
    const std::vector<Trial> trials = random_trials(random);
    for (std::size_t i = 0; i < trials.size(); ++i) {
        const Trial& t = trials[i];
        INFO("scene " << i << ": " << t.kind << ", " << t.boxes << " boxes, seed " << t.seed
                      << (t.filtered ? ", filtered, " : ", ") << t.setting.text() << ", "
                      << (t.options.order == Order::Any ? "any order" : "sorted") << ", scratch "
                      << t.options.scratch_bytes);
        check_trial(t, random.bits());
    }
}

TEST_CASE("25,000 boxes: the bytes of an independent sweep", "[device]") {
    std::vector<test::Setting> fast;
    for (const test::Setting& setting : test::settings({}))
        if (!slow(setting.name)) fast.push_back(setting);
    for (const char* const kind : {"uniform", "clusters", "mixed"}) {
        INFO(kind);
        const std::vector<Aabb> boxes = scenes::make_boxes(kind, 25000, 3);
        const std::vector<Pair> expected = test::pairs_by_sweep(boxes);
        REQUIRE(expected.size() > 5000);
        test::with_each(fast, test::default_scratch,
                        [&](BroadPhase& broad_phase) { test::check_scene(broad_phase, boxes, {}, expected); });
    }
}
