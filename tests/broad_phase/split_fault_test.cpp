// Devices that fail in a search: others do their work, the pairs are whole, and the report says so.
#include <CL/cl.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <memory>
#include <string>
#include <vector>

#include "bench/scenes/boxes.hpp"
#include "clinch/pipeline.hpp"
#include "src/broad_phase/broad_phase_impl.hpp"
#include "tests/broad_phase/every_algorithm.hpp"
#include "tests/device/crew_faults.hpp"
#include "tests/device/devices.hpp"

using namespace clinch;
using test::Failing;
using test::from_call;

namespace {

constexpr std::uint32_t devices = 3;

void check_report(const Report& report, std::size_t device) {
    REQUIRE(report.warnings.size() == 1);
    CHECK_THAT(report.warnings[0], Catch::StartsWith("device " + std::to_string(device) + " ('"));
    CHECK_THAT(report.warnings[0], Catch::Contains("failed"));
}

}  // namespace

TEST_CASE("a device that fails in a split search is retired and the pairs are whole", "[device]") {
    constexpr std::uint64_t seed = 61;
    test::Random random(seed);
    Failing failing(devices);
    // llvmpipe, which has a quirk, compiles each kernel object anew.
    const std::size_t most = failing.context.devices()[0].quirks.empty() ? 8 : 3;
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", 3000, seed);
    const std::vector<Pair> expected = test::pairs_by_hand(boxes);
    for (const std::string& name : test::names_for(failing.context.devices()[0])) {
        if (!detail::algorithm_named(name).needs_device) continue;
        BroadPhaseOptions options;
        options.algorithm = name;
        for (const bool closed : {false, true}) {  // devices that are yet to be opened fail in that, too
            failing.reset(closed);
            const std::vector<std::size_t> calls = failing.count([&] {
                BroadPhase broad(failing.context, options);
                broad.find(boxes);
            });
            for (std::size_t device = 0; device < devices; ++device) {
                REQUIRE(calls[device] > 5);
                for (const std::size_t number : test::numbers_of(calls[device], closed ? 3 : most, random)) {
                    INFO(name << ", device " << device << (closed ? ", closed," : "") << " fails from call " << number
                              << " of " << calls[device] << ", seed " << seed);
                    failing.reset(closed);
                    BroadPhase broad(failing.context, options);
                    failing.faults.fail(from_call(device, number), CL_OUT_OF_RESOURCES);
                    CHECK(test::same(broad.find(boxes), expected));
                    if (failing.retired() == 0) continue;  // a few calls fewer this time
                    check_report(broad.report(), device);
                    CHECK_FALSE(failing.context.impl().in_use(device));
                    // The next search does without.
                    CHECK(test::same(broad.find(boxes), expected));
                    CHECK(broad.report().warnings.empty());
                    CHECK(broad.report().broad_split.size() == devices - 1);
                }
            }
        }
    }
}

TEST_CASE("a device that fails while boxes stray from their slabs is retired and the pairs are whole", "[device]") {
    constexpr std::uint64_t seed = 62;
    test::Random random(seed);
    Failing failing(devices);
    const std::size_t most = failing.context.devices()[0].quirks.empty() ? 12 : 3;
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", 3000, seed);
    std::vector<Aabb> moved = boxes;
    for (std::size_t i = 0; i < 40; ++i) std::swap(moved[i], moved[i + 1000]);
    const std::vector<Pair> expected = test::pairs_by_hand(moved);
    BroadPhaseOptions options;
    options.algorithm = "bvh";
    std::vector<std::size_t> calls;
    {
        BroadPhase broad(failing.context, options);
        broad.find(boxes);
        calls = failing.count([&] { CHECK(test::same(broad.find(moved), expected)); });
    }
    for (std::size_t device = 0; device < devices; ++device)
        for (const std::size_t number : numbers_of(calls[device], most, random)) {
            INFO("device " << device << " fails from call " << number << " of " << calls[device] << ", seed " << seed);
            failing.reset(false);
            BroadPhase broad(failing.context, options);
            broad.find(boxes);
            failing.faults.fail(from_call(device, number), CL_OUT_OF_RESOURCES);
            CHECK(test::same(broad.find(moved), expected));
            if (failing.retired() == 0) continue;  // a few calls fewer this time
            check_report(broad.report(), device);
            CHECK(test::same(broad.find(moved), expected));
        }
}

TEST_CASE("when all devices fail, the call does, and the last one is asked again", "[device]") {
    Failing failing(devices);
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", 2000, 3);
    BroadPhaseOptions options;
    options.algorithm = "grid";
    if (!detail::runs_on(detail::algorithm_named("grid"), failing.context.devices()[0])) options.algorithm = "brute";
    BroadPhase broad(failing.context, options);
    failing.faults.fail(
        [](std::size_t, const std::string& name, std::size_t) { return name == "clEnqueueNDRangeKernel"; },
        CL_OUT_OF_RESOURCES);
    CHECK_THROWS_AS(broad.find(boxes), Error);
    CHECK(failing.retired() == devices - 1);
    failing.faults.watch();
    CHECK(test::same(broad.find(boxes), test::pairs_by_hand(boxes)));
    CHECK(broad.report().broad_split.empty());
}

TEST_CASE("a search on one device goes to the next when it fails", "[device]") {
    Failing failing(devices);
    failing.context.impl().least_boxes_a_device = 1000000;
    const std::vector<Aabb> boxes = scenes::make_boxes("density", 12000, 4);
    const std::vector<Pair> expected = test::pairs_by_sweep(boxes);
    const std::size_t first = failing.context.impl().primary();
    BroadPhaseOptions options;
    options.algorithm = "bvh";
    for (const std::size_t number : {0u, 3u, 9u, 20u}) {
        INFO("from call " << number);
        failing.reset(true);
        BroadPhase broad(failing.context, options);
        failing.faults.fail(from_call(first, number), CL_DEVICE_NOT_AVAILABLE);
        CHECK(broad.count(boxes) == expected.size());
        check_report(broad.report(), first);
        CHECK(test::same(broad.find(boxes), expected));
        CHECK(broad.report().warnings.empty());
    }
    // Updates, of which the device holds what it needs for the next.
    if (!detail::runs_on(detail::algorithm_named("grid"), failing.context.devices()[0])) return;
    options.algorithm = "grid";
    options.events = true;
    failing.reset(true);
    BroadPhase broad(failing.context, options);
    std::vector<Aabb> moved = boxes;
    broad.find(moved);
    std::vector<Pair> now = expected;
    for (std::uint32_t step = 0; step < 4; ++step) {
        const std::vector<std::uint32_t> changed{step, step + 100, step + 5000};
        for (const std::uint32_t i : changed) moved[i].max[step % 3] += 2.5f;
        if (step == 2) failing.faults.fail(from_call(first, 7), CL_DEVICE_NOT_AVAILABLE);
        const std::vector<Pair> before = now;
        now = test::pairs_by_sweep(moved);
        CHECK(test::same(broad.update(moved, changed), now));
        const bool lost = broad.report().warnings.size() == 2;  // with the list before
        if (step == 2) CHECK_THAT(broad.report().warnings.at(0), Catch::Contains("failed"));
        CHECK(broad.added().size() == (lost ? now.size() : now.size() - before.size()));
    }
}

TEST_CASE("a step of a pipeline goes to other devices when one fails", "[device][together]") {
    Failing failing(devices);
    failing.context.impl().least_boxes_a_device = 1000;
    Scene scene;
    const ShapeId ball = scene.add_shape(Sphere{0.6});
    test::Random random(8);
    for (int i = 0; i < 4000; ++i) {
        const auto at = [&] { return random.between(0.0, 14.0); };
        const double x = at(), y = at(), z = at();
        scene.add_body({ball, Pose{{x, y, z}}});
    }
    scene.add_body({scene.add_shape(Plane{{0, 0, 1}, 0.3}), Pose{}});
    PipelineOptions options;
    options.broad_phase.algorithm = "brute";
    options.contacts = true;
    options.narrow_phase.contacts_per_pair = 1;
    Context alone = Context::host_only();
    PipelineOptions on_host = options;
    on_host.broad_phase.algorithm = "host-brute";
    Pipeline reference(alone, on_host);
    const std::string expected = test::bytes(reference.step(scene).pairs());
    std::string contacts;
    const std::vector<std::size_t> calls = failing.count([&] {
        Pipeline pipeline(failing.context, options);
        const StepResult& result = pipeline.step(scene);
        CHECK(test::bytes(result.pairs()) == expected);
        CHECK(result.report().broad_split.size() == devices);
        contacts = test::bytes(result.contacts());
    });
    const std::uint64_t seed = 9;
    test::Random numbers(seed);
    for (std::size_t device = 0; device < devices; ++device)
        for (const std::size_t number : test::numbers_of(calls[device], 10, numbers)) {
            INFO("device " << device << " fails from call " << number << " of " << calls[device] << ", seed " << seed);
            failing.reset(false);
            Pipeline pipeline(failing.context, options);
            failing.faults.fail(from_call(device, number), CL_OUT_OF_RESOURCES);
            const StepResult& result = pipeline.step(scene);
            CHECK(test::bytes(result.pairs()) == expected);
            CHECK(test::bytes(result.contacts()) == contacts);
            if (failing.retired() > 0) CHECK_FALSE(result.report().warnings.empty());
        }
}

TEST_CASE("what was kept on a device that a split has retired is not used again", "[device]") {
    Failing failing(devices);
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", 3000, 12);
    const std::vector<Pair> expected = test::pairs_by_hand(boxes);
    const std::size_t first = failing.context.impl().primary();
    for (const char* const algorithm : {"brute", "bvh"}) {
        INFO(algorithm);
        failing.reset(false);
        BroadPhaseOptions options;
        options.algorithm = algorithm;
        BroadPhase broad(failing.context, options), other(failing.context, options);
        const auto streamed = [&](BroadPhase& by) {
            std::vector<Pair> all;
            by.stream(boxes, [&](View<const Pair> pairs) { all.insert(all.end(), pairs.begin(), pairs.end()); });
            std::sort(all.begin(), all.end());
            return all;
        };
        CHECK(streamed(broad) == expected);
        CHECK(streamed(other) == expected);
        failing.faults.fail(from_call(first, 12), CL_OUT_OF_RESOURCES);
        CHECK(test::same(broad.find(boxes), expected));
        REQUIRE_FALSE(failing.context.impl().in_use(first));
        CHECK(streamed(broad) == expected);
        CHECK(streamed(other) == expected);  // it has seen no failure itself
        CHECK(broad.report().warnings.empty());
        CHECK(failing.retired() == 1);
    }
}

TEST_CASE("a step after its narrow phase has retired a device begins on another one", "[device]") {
    Failing failing(devices);
    failing.context.impl().least_boxes_a_device = 1000000;
    const std::size_t first = failing.context.impl().primary();
    Scene scene;
    const ShapeId ball = scene.add_shape(Sphere{0.6});
    test::Random random(13);
    const auto whole = [&] { return static_cast<double>(random.below(768)); };  // sums of such heights are exact
    for (int i = 0; i < 3000; ++i)
        scene.add_body({ball, Pose{{random.between(0.0, 12.0), random.between(0.0, 12.0), whole() / 64.0}}});
    PipelineOptions options;
    options.broad_phase.algorithm = "bvh";
    options.contacts = true;
    options.narrow_phase.contacts_per_pair = 1;
    Pipeline reference(failing.context, options);
    const auto both = [&](Pipeline& pipeline) {
        const StepResult& result = pipeline.step(scene);
        return test::bytes(result.pairs()) + test::bytes(result.contacts());
    };
    const auto move = [&](double way) {
        for (std::uint32_t i = 0; i < scene.row_count(); i += 2) {
            Pose pose = scene.body({i}).pose;
            pose.position.z += way;
            scene.set_pose({i}, pose);
        }
    };
    const std::string before = both(reference);
    move(0.25);
    const std::string after = both(reference);
    move(-0.25);
    Pipeline pipeline(failing.context, options);
    std::size_t calls = 0;  // those of the step, some more or fewer each time; the last are the narrow phase's
    failing.faults.fail(
        [&](std::size_t, const std::string&, std::size_t) {
            ++calls;
            return false;
        },
        CL_SUCCESS);
    CHECK((both(pipeline) == before));
    failing.faults.watch();
    Pipeline struck(failing.context, options);
    failing.faults.fail(from_call(first, calls - 10), CL_OUT_OF_RESOURCES);
    CHECK((both(struck) == before));
    REQUIRE_FALSE(failing.context.impl().in_use(first));
    CHECK_FALSE(struck.step(scene).pairs().empty());
    move(0.25);
    CHECK((both(struck) == after));
    CHECK(struck.step(scene).report().warnings.empty());
    CHECK(failing.retired() == 1);
}
