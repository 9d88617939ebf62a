// One broad phase on several devices: the bytes of one, for every algorithm, whatever the shares.
#include "src/broad_phase/split.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <memory>

#include "bench/scenes/boxes.hpp"
#include "src/broad_phase/broad_phase_impl.hpp"
#include "tests/broad_phase/every_algorithm.hpp"
#include "tests/broad_phase/oracle.hpp"
#include "tests/device/devices.hpp"

using namespace clinch;

namespace {

std::vector<double> random_fractions(std::size_t count, test::Random& random) {
    std::vector<double> fractions;
    for (std::size_t i = 0; i < count; ++i) fractions.push_back(random.below(6) == 0 ? 0.0 : random.between(0.01, 1.0));
    fractions[random.below(count)] = 0.5;
    return fractions;
}

// Device algorithms that all devices run.
std::vector<std::string> names_for(const Context& context) {
    std::vector<std::string> names;
    for (const detail::AlgorithmRow& row : detail::registry()) {
        bool all = row.needs_device;
        for (const DeviceInfo& info : context.devices()) all = all && detail::runs_on(row, info);
        if (all) names.emplace_back(row.name);
    }
    return names;
}

// A BroadPhase that splits whatever it is given.
class Splitter {
public:
    Splitter(Context& context, const BroadPhaseOptions& options) : broad_phase_(context, options) {
        context.impl().least_boxes_a_device = 1;
        broad_phase_.impl().split = std::make_unique<detail::BroadSplit>(context.impl(), broad_phase_.impl().options);
        even();
    }
    void even() { force(std::vector<double>(broad_phase_.impl().context.infos.size(), 1.0)); }
    void force(const std::vector<double>& fractions) { broad_phase_.impl().split->force(fractions); }
    BroadPhase& get() { return broad_phase_; }

private:
    BroadPhase broad_phase_;
};

}  // namespace

TEST_CASE("200 random scenes on 2, 3 and 4 devices: the oracle's bytes with any shares", "[device][together]") {
    const std::uint64_t seed = 20261122;
    INFO("seed " << seed);
    test::Random random(seed);
    const std::vector<scenes::BoxKind> kinds = scenes::box_kinds();
    int scene = 0;
    for (const std::uint32_t devices : {2u, 3u, 4u}) {
        Context context = test::several(devices);
        const std::vector<std::string> names = names_for(context);
        std::vector<std::unique_ptr<Splitter>> splitters;
        for (const std::string& name : names) {
            BroadPhaseOptions options;
            options.algorithm = name;
            if (random.below(3) == 0) options.scratch_bytes = 200000;
            splitters.push_back(std::make_unique<Splitter>(context, options));
        }
        for (int round = 0; round < 67; ++round, ++scene) {
            Splitter& splitter = *splitters[static_cast<std::size_t>(scene) % names.size()];
            const scenes::BoxKind& kind = kinds[random.below(kinds.size())];
            const std::size_t n = devices + random.below(kind.all_pairs ? 200 : 2500);
            const std::vector<Aabb> boxes = scenes::make_boxes(kind.name, n, random.below(1000));
            const bool filtered = random.below(3) == 0;
            const test::Filters filters = test::random_filters(filtered ? n : 0, random);
            const FilterColumns columns = filtered ? filters.columns() : FilterColumns{};
            INFO("scene " << scene << ": " << kind.name << ", " << n << " boxes on " << devices << " devices, "
                          << splitter.get().impl().options.algorithm << (filtered ? ", filtered" : ""));
            splitter.force(random_fractions(devices, random));
            const std::vector<Pair> expected = test::pairs_by_hand(boxes, columns);
            CHECK(test::same(splitter.get().find(boxes, columns), expected));
            const Report& report = splitter.get().report();
            CHECK(report.pairs == expected.size());
            CHECK(report.broad_split.size() == devices);
            std::vector<bool> there(devices, false);
            for (const DeviceWork& work : report.broad_split) there.at(work.device) = true;
            CHECK(there == std::vector<bool>(devices, true));
            CHECK(report.rejected.empty());
            CHECK(report.warnings.empty());
            if (round % 4 == 0) CHECK(splitter.get().count(boxes, columns) == expected.size());
        }
    }
}

TEST_CASE("a split in any order has the same pairs", "[device][together]") {
    Context context = test::several(3);
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", 4000, 5);
    const std::vector<Pair> expected = test::pairs_by_hand(boxes);
    for (const std::string& name : names_for(context)) {
        INFO(name);
        BroadPhaseOptions options;
        options.algorithm = name;
        options.order = Order::Any;
        Splitter splitter(context, options);
        const View<const Pair> found = splitter.get().find(boxes);
        std::vector<Pair> pairs(found.begin(), found.end());
        std::sort(pairs.begin(), pairs.end());
        CHECK(pairs == expected);
        CHECK(splitter.get().report().broad_split.size() == 3);
    }
}

TEST_CASE("a stream of several devices has every pair once, in pieces", "[device][together]") {
    const std::uint64_t seed = 8;
    INFO("seed " << seed);
    test::Random random(seed);
    Context context = test::several(3);
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", 4000, 7);
    const test::Filters filters = test::random_filters(boxes.size(), random);
    const std::vector<Pair> all = test::pairs_by_hand(boxes), some = test::pairs_by_hand(boxes, filters.columns());
    REQUIRE(some.size() < all.size());
    for (const std::string& name : names_for(context)) {
        INFO(name);
        for (const std::size_t piece : {std::size_t{100}, all.size()}) {
            BroadPhaseOptions options;
            options.algorithm = name;
            options.stream_bytes = piece * sizeof(Pair);
            Splitter splitter(context, options);
            for (const bool filtered : {false, false, true}) {  // the second knows how many the first had
                splitter.force(random_fractions(3, random));
                std::vector<Pair> pairs;
                const std::uint64_t count = splitter.get().stream(
                    boxes,
                    [&](View<const Pair> found) {
                        CHECK(found.size() <= piece);
                        CHECK(std::is_sorted(found.begin(), found.end()));
                        pairs.insert(pairs.end(), found.begin(), found.end());
                    },
                    filtered ? filters.columns() : FilterColumns{});
                std::sort(pairs.begin(), pairs.end());
                CHECK((pairs == (filtered ? some : all)));
                CHECK(count == pairs.size());
                CHECK(splitter.get().report().pairs == count);
                CHECK(splitter.get().report().broad_split.size() == 3);
            }
            CHECK_THROWS_WITH(
                splitter.get().stream(boxes, [](View<const Pair>) { throw std::runtime_error("enough"); }), "enough");
            CHECK(splitter.get().find(boxes).size() == all.size());
        }
        BroadPhaseOptions options;
        options.algorithm = name;
        options.max_pairs = all.size() - 1;
        Splitter limited(context, options);
        CHECK_THROWS_WITH(limited.get().stream(boxes, [](View<const Pair>) {}),
                          Catch::StartsWith("there are " + std::to_string(all.size()) + " pairs and at most "));
    }
}

TEST_CASE("a split names what is no box, and the true count of too many pairs", "[device]") {
    Context context = test::several(3);
    std::vector<Aabb> boxes = scenes::make_boxes("uniform", 2000, 6);
    const std::uint64_t pairs = test::pairs_by_hand(boxes).size();
    REQUIRE(pairs > 300);
    for (const std::string& name : names_for(context)) {
        INFO(name);
        BroadPhaseOptions options;
        options.algorithm = name;
        options.max_pairs = pairs - 1;
        Splitter splitter(context, options);
        CHECK_THROWS_WITH(splitter.get().find(boxes),
                          Catch::StartsWith("there are " + std::to_string(pairs) + " pairs and at most "));
        options.max_pairs = 10;  // less than a slab has
        Splitter strict(context, options);
        CHECK_THROWS_WITH(strict.get().find(boxes),
                          Catch::StartsWith("there are " + std::to_string(pairs) + " pairs and at most "));
        options.max_pairs = pairs;
        Splitter enough(context, options);
        CHECK(enough.get().find(boxes).size() == pairs);
        std::vector<Aabb> some = boxes;
        some[1234].min[2] = std::numeric_limits<float>::quiet_NaN();
        enough.get().find(some);
        REQUIRE(enough.get().report().rejected.size() == 1);
        CHECK(enough.get().report().rejected[0].body == 1234);
    }
}

TEST_CASE("boxes move from call to call, within their slabs and out of them: the oracle's bytes",
          "[device][together]") {
    const std::uint64_t seed = 81;
    INFO("seed " << seed);
    test::Random random(seed);
    Context context = test::several(3);
    for (const std::string& name : names_for(context)) {
        BroadPhaseOptions options;
        options.algorithm = name;
        Splitter splitter(context, options);
        std::vector<Aabb> boxes = scenes::make_boxes("uniform", 800, 18);
        for (int call = 0; call < 30; ++call) {
            INFO(name << ", call " << call);
            // All move a little, or one far; after a long rest, and soon again.
            const bool one = call == 23 || call == 26, all = call == 2 || call == 4 || call == 5;
            for (std::size_t k = 0; k < (one ? 1 : all ? boxes.size() : 0); ++k) {
                Aabb& box = boxes[one ? random.below(boxes.size()) : k];
                for (int d = 0; d < 3; ++d) {
                    const double far = one ? (box.min[d] > 10.0f ? -9.0 : 9.0) : random.between(-0.3, 0.3);
                    box.min[d] += static_cast<float>(far);
                    box.max[d] += static_cast<float>(far);
                }
            }
            const std::vector<Pair> expected = test::pairs_by_hand(boxes);
            if (call % 11 == 5) CHECK(splitter.get().count(boxes) == expected.size());
            CHECK(test::same(splitter.get().find(boxes), expected));
            CHECK(splitter.get().report().broad_split.size() == 3);
        }
    }
}

TEST_CASE("boxes that stray in a call that finds too many pairs are counted right", "[device]") {
    Context context = test::several(3);
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", 1500, 19);
    std::vector<Aabb> moved = boxes;
    for (std::size_t i = 0; i < 30; ++i) moved[i] = {{0, 0, 0}, {20, 20, 20}};  // into all slabs
    const std::uint64_t few = test::pairs_by_hand(boxes).size(), many = test::pairs_by_hand(moved).size();
    REQUIRE(many > 2 * few);
    for (const std::string& name : names_for(context))
        for (const std::uint64_t most : {few, many - 1}) {
            INFO(name << ", at most " << most);
            BroadPhaseOptions options;
            options.algorithm = name;
            options.max_pairs = most;
            Splitter splitter(context, options);
            CHECK(splitter.get().find(boxes).size() == few);
            CHECK_THROWS_WITH(splitter.get().find(moved),
                              Catch::StartsWith("there are " + std::to_string(many) + " pairs and at most "));
            CHECK(test::same(splitter.get().find(boxes), test::pairs_by_hand(boxes)));
        }
}

TEST_CASE("boxes that come together go to one device", "[device]") {
    Context context = test::several(2);
    context.impl().least_boxes_a_device = 1;
    BroadPhaseOptions options;
    options.algorithm = "brute";
    BroadPhase broad_phase(context, options);
    std::vector<Aabb> boxes = scenes::make_boxes("uniform", 1000, 20);
    CHECK(test::same(broad_phase.find(boxes), test::pairs_by_hand(boxes)));
    CHECK(broad_phase.report().broad_split.size() == 2);
    for (Aabb& box : boxes) box = {{1, 1, 1}, {2, 2, 2}};
    CHECK(broad_phase.find(boxes).size() == 1000u * 999u / 2u);
    CHECK(broad_phase.report().broad_split.empty());
}

TEST_CASE("no device is opened for boxes that are too few for it", "[device]") {
    Context context = test::several(3);
    context.impl().least_boxes_a_device = 1000;
    BroadPhaseOptions options;
    options.algorithm = "brute";
    BroadPhase broad_phase(context, options);
    const auto opened = [&] {
        const std::vector<DeviceReport> reports = context.report();
        return std::count_if(reports.begin(), reports.end(), [](const DeviceReport& r) { return r.opened; });
    };
    broad_phase.find(scenes::make_boxes("cubes", 1999, 1));
    CHECK(broad_phase.report().broad_split.empty());
    CHECK(opened() == 1);
    broad_phase.find(scenes::make_boxes("cubes", 2000, 1));
    CHECK(broad_phase.report().broad_split.size() == 2);
    CHECK(opened() == 2);
    // All in one place: every box reaches over every cut.
    broad_phase.find(std::vector<Aabb>(3000, Aabb{{0, 0, 0}, {1, 1, 1}}));
    CHECK(broad_phase.report().pairs == 3000u * 2999u / 2u);
}

TEST_CASE("what a split's progress throws ends it", "[device]") {
    Context context = test::several(2);
    BroadPhaseOptions options;
    options.algorithm = "brute";
    options.scratch_bytes = 1 << 16;
    bool stop = true;
    double last = 0.0;
    options.progress = [&](double done) {
        if (stop) throw std::runtime_error("enough");
        last = std::max(last, done);
    };
    Splitter splitter(context, options);
    const std::vector<Aabb> boxes = scenes::make_boxes("cubes", 3000, 9);
    CHECK_THROWS_WITH(splitter.get().find(boxes), "enough");
    stop = false;
    CHECK(test::same(splitter.get().find(boxes), test::pairs_by_hand(boxes)));
    CHECK(last == Approx(1.0));
}
