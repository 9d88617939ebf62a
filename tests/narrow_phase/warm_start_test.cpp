// Pairs that start from what the last call has left of them.
#include "clinch/warm_start.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <utility>

#include "clinch/narrow_phase.hpp"
#include "clinch/pipeline.hpp"
#include "src/device/quirks.hpp"
#include "src/narrow_phase/warm_start_impl.hpp"
#include "tests/device/devices.hpp"
#include "tests/narrow_phase/narrow_scenes.hpp"

using namespace clinch;
using test::found;
using test::same_bytes;
using test::with_precision;

namespace {

constexpr std::uint64_t seed = 91;

constexpr std::size_t capsule = 2, cylinder = 3;

// Boxes, hulls, and bodies of another kind: with corners to remember, or round and without.
Scene bodies(std::size_t n, std::size_t other, double edge, test::Random& random) {
    Scene scene;
    for (std::size_t i = 0; i < n; ++i) {
        Body body;
        body.shape = scene.add_shape(test::random_shape(i % 3 == 0 ? 1 : i % 3 == 1 ? 6 : other, random));
        body.pose.position = {random.between(0, edge), random.between(0, edge), random.between(0, edge)};
        body.pose.rotation = test::random_rotation(random);
        scene.add_body(body);
    }
    return scene;
}

void move_all(Scene& scene, double step, test::Random& random) {
    for (std::uint32_t i = 0; i < scene.row_count(); ++i) {
        Pose pose = scene.body({i}).pose;
        pose.position = {pose.position.x + random.between(-step, step), pose.position.y + random.between(-step, step),
                         pose.position.z + random.between(-step, step)};
        scene.set_pose({i}, pose);
    }
}

// Whether the device does these itself.
bool iterates(const DeviceInfo& device, double precision) {
    return device.fp64 || (precision < 0.75 && detail::most_loop_iterations(device) == 0xffffffffu);
}

// Against float64 of the host, which starts from nothing.
void check(const std::vector<Contact>& contacts, const Scene& scene, const std::vector<Pair>& pairs) {
    Context host = Context::host_only();
    NarrowPhase narrow(host, with_precision(1.0));
    const auto exact = test::by_pair(narrow.find(scene, pairs)),
               warm = test::by_pair({contacts.data(), contacts.size()});
    REQUIRE(exact.size() > 20);
    for (const auto& [pair, c] : warm) {
        INFO("pair " << pair.first << ", " << pair.second << ", distance " << c.distance << ", error " << c.error);
        const auto same = exact.find(pair);
        const double from_above = same == exact.end() ? 0.0 : same->second.distance - same->second.error;
        CHECK(c.distance - c.error <= (same == exact.end() ? 0.0 : same->second.distance + same->second.error));
        CHECK(c.distance + c.error >= from_above);
        CHECK(std::abs(c.normal.x * c.normal.x + c.normal.y * c.normal.y + c.normal.z * c.normal.z - 1.0) < 1e-5);
    }
    for (const auto& [pair, c] : exact) {
        INFO("pair " << pair.first << ", " << pair.second << ", distance " << c.distance);
        CHECK((c.distance + c.error >= 0.0 || warm.count(pair) == 1));
    }
}

}  // namespace

TEST_CASE("pairs that start warm keep every promise while bodies move", "[device][builds]") {
    Context context = test::with_lanes(0, list_devices()[0].lanes);
    for (const double precision : {0.0, 1.0}) {
        INFO("seed " << seed << ", precision " << precision);
        test::Random random(seed);
        Scene scene = bodies(40, capsule, 2.0, random);
        const std::vector<Pair> pairs = test::all_pairs(scene);
        NarrowPhase narrow(context, with_precision(precision)), twin(context, with_precision(precision));
        WarmStart warm, twin_warm;
        const std::vector<Contact> cold = found(narrow, scene, pairs, nullptr);
        CHECK(narrow.report().warm == 0);
        CHECK(same_bytes(found(narrow, scene, pairs, &warm), cold));  // nothing is kept yet
        found(twin, scene, pairs, &twin_warm);
        const bool on_device = iterates(list_devices()[0], precision);
        CHECK((warm.size() > pairs.size() / 3) == on_device);
        for (int step = 0; step < 5; ++step) {
            INFO("step " << step);
            move_all(scene, step == 4 ? 1.0 : 0.01, random);
            const std::vector<Contact> contacts = found(narrow, scene, pairs, &warm);
            check(contacts, scene, pairs);
            CHECK((narrow.report().warm > pairs.size() / 3) == on_device);
            CHECK(same_bytes(found(twin, scene, pairs, &twin_warm), contacts));
        }
        warm.clear();
        CHECK(warm.size() == 0);
        const std::vector<Contact> afresh = found(narrow, scene, pairs, &warm);
        CHECK(same_bytes(afresh, found(narrow, scene, pairs, nullptr)));
    }
}

TEST_CASE("what is kept of other bodies does no harm", "[device][builds]") {
    Context context = test::with_lanes(0, list_devices()[0].lanes);
    test::Random random(seed);
    NarrowPhase narrow(context, with_precision(0.5));
    WarmStart warm;
    for (int scenes = 0; scenes < 6; ++scenes) {
        INFO("seed " << seed << ", scene " << scenes);
        const Scene scene = bodies(36 + random.below(8), cylinder, random.between(1.0, 2.0), random);
        std::vector<Pair> pairs = test::all_pairs(scene);
        if (scenes > 3)
            for (std::size_t i = pairs.size() - 1; i > 0; --i) std::swap(pairs[i], pairs[random.below(i + 1)]);
        check(found(narrow, scene, pairs, &warm), scene, pairs);
        const auto contacts = test::by_pair(narrow.find(scene, pairs, &warm));
        for (const Pair& pair : narrow.touching(scene, pairs, &warm)) CHECK(contacts.count({pair.a, pair.b}) == 1);
    }
}

TEST_CASE("an error of the narrow phase leaves nothing to start from", "[device][builds]") {
    Context context = test::with_lanes(0, list_devices()[0].lanes);
    test::Random random(seed);
    const Scene scene = bodies(30, capsule, 2.0, random);
    std::vector<Pair> pairs = test::all_pairs(scene);
    NarrowPhase narrow(context, with_precision(0.0));
    WarmStart warm;
    found(narrow, scene, pairs, &warm);
    CHECK((warm.size() > 0) == iterates(list_devices()[0], 0.0));
    pairs.push_back({7, 1000});
    CHECK_THROWS_AS(found(narrow, scene, pairs, &warm), Error);
    CHECK(warm.size() == 0);
}

TEST_CASE("a pipeline keeps what pairs start from, and drops it when told", "[device][builds]") {
    Context context = test::with_lanes(0, list_devices()[0].lanes);
    test::Random random(seed);
    Scene scene = bodies(60, capsule, 2.0, random);
    PipelineOptions options;
    options.contacts = true;
    options.narrow_phase.precision = 0.0;
    Pipeline cold(context, options);
    options.warm_start = true;
    Pipeline warm(context, options);
    const bool iterated = iterates(list_devices()[0], 0.0);
    for (int step = 0; step < 4; ++step) {
        INFO("seed " << seed << ", step " << step);
        if (step == 3) warm.drop_warm_start();
        const StepResult& result = warm.step(scene);
        REQUIRE(result.pairs().size() > 128);
        CHECK((result.narrow_report().warm > 0) == (iterated && (step == 1 || step == 2)));
        CHECK(cold.step(scene).narrow_report().warm == 0);
        check({result.contacts().begin(), result.contacts().end()}, scene,
              {result.pairs().begin(), result.pairs().end()});
        move_all(scene, 0.01, random);
    }
}

TEST_CASE("what is kept of a pair is found again in lists of any order", "[host]") {
    test::Random random(seed);
    WarmStart warm;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> expected;
    for (std::uint32_t round = 0; round < 40; ++round) {
        INFO("seed " << seed << ", round " << round);
        std::vector<Pair> pairs;
        for (std::uint32_t a = 0; a < 200; ++a)
            for (std::uint32_t b = a + 1; b < 200; ++b)
                if (random.below(round % 2 == 0 ? 2 : 40) == 0) pairs.push_back({a, b});
        if (round % 3 != 0)
            for (std::size_t i = pairs.size() - 1; i > 0; --i) std::swap(pairs[i], pairs[random.below(i + 1)]);
        WarmStart::Impl& kept = warm.impl();
        std::size_t known = 0;
        for (const Pair& pair : pairs) known += expected.count({pair.a, pair.b});
        CHECK(kept.take({pairs.data(), pairs.size()}) == known);
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> next;
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            const auto before = expected.find({pairs[i].a, pairs[i].b});
            REQUIRE(kept.corners[i].names[0] == (before == expected.end() ? WarmStart::Impl::none : before->second));
            kept.corners[i].names[0] = next[{pairs[i].a, pairs[i].b}] = static_cast<std::uint32_t>(i) * 64 + round;
        }
        CHECK(warm.size() == pairs.size());
        expected = next;
    }
}
