// Devices that fail while both phases are at work: the others do it all, and the contacts are whole.
#include <CL/cl.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "clinch/pipeline.hpp"
#include "src/pipeline/pipeline_impl.hpp"
#include "tests/device/devices.hpp"
#include "tests/device/faults.hpp"
#include "tests/narrow_phase/narrow_scenes.hpp"
#include "tests/random.hpp"

using namespace clinch;
using test::Faults;

namespace {

constexpr std::uint32_t devices = 3;

Scene heap(test::Random& random) {
    Scene scene;
    const ShapeId ball = scene.add_shape(Sphere{0.4}), box = scene.add_shape(Box{{0.3, 0.4, 0.5}});
    scene.add_body({scene.add_shape(Plane{{0, 0, 1}, 0.3}), Pose{}});
    for (std::size_t i = 0; i < 800; ++i) {
        Body body;
        body.shape = i % 2 == 0 ? ball : box;
        body.pose.position = {random.between(0, 8), random.between(0, 8), random.between(0, 8)};
        body.pose.rotation = test::random_rotation(random);
        scene.add_body(body);
    }
    return scene;
}

PipelineOptions streaming() {
    PipelineOptions options;
    options.broad_phase.algorithm = "bvh";
    options.contacts = true;
    options.streaming = true;
    return options;
}

// From call `number` of a device on all its calls fail.
Faults::Choice from_call(std::size_t device, std::size_t number) {
    return [=, seen = std::size_t{0}](std::size_t d, const std::string&, std::size_t) mutable {
        return d == device && seen++ >= number;
    };
}

}  // namespace

TEST_CASE("a device that fails while a step streams is retired and the contacts are whole", "[device]") {
    constexpr std::uint64_t seed = 97;
    INFO("seed " << seed);
    test::Random random(seed);
    const Scene scene = heap(random);
    Context context = test::several(devices);
    Faults faults(context);
    Context::Impl& impl = context.impl();
    impl.least_boxes_a_device = 1;
    const auto step_afresh = [&](unsigned broad_devices) {
        Pipeline pipeline(context, streaming());
        pipeline.impl().phases->forced = {false, broad_devices, 300};
        const StepResult& result = pipeline.step(scene);
        return std::pair(test::bytes(result.contacts()), result.report().warnings);
    };
    const std::string right = step_afresh(1).first;
    REQUIRE(right.size() > 500 * sizeof(Contact));
    std::size_t struck = 0, tried = 0;
    for (const unsigned broad_devices : {1u, 2u}) {
        std::vector<std::size_t> calls(devices, 0);
        faults.fail(
            [&](std::size_t d, const std::string&, std::size_t) {
                ++calls[d];
                return false;
            },
            CL_SUCCESS);
        CHECK((step_afresh(broad_devices).first == right));
        for (std::size_t device = 0; device < devices; ++device) {
            if (calls[device] < 5) continue;  // the others were done before it had begun
            for (int k = 0; k < 10; ++k) {
                const std::size_t number = k == 0 ? 0 : random.below(calls[device]);
                INFO("broad phase on " << broad_devices << ", device " << device << " fails at call " << number);
                faults.fail(from_call(device, number), CL_OUT_OF_RESOURCES);
                const auto [contacts, warnings] = step_afresh(broad_devices);
                CHECK((contacts == right));
                ++tried;
                // Chance has it which device makes the last calls.
                if (!faults.failed().empty()) {
                    ++struck;
                    REQUIRE(warnings.size() == 1);
                    CHECK_THAT(warnings[0], Catch::StartsWith("device " + std::to_string(device) + " ('"));
                }
                faults.watch();
                impl.retired.clear();
            }
        }
    }
    CHECK(tried >= 20);
    CHECK(struck > tried / 2);
}

TEST_CASE("a step that streams fails when no device is left, and the next one is right", "[device]") {
    test::Random random(98);
    const Scene scene = heap(random);
    Context context = test::several(devices);
    Faults faults(context);
    context.impl().least_boxes_a_device = 1;
    Pipeline pipeline(context, streaming());
    pipeline.impl().phases->forced.chunk_pairs = 300;
    const std::string right = test::bytes(pipeline.step(scene).contacts());
    pipeline.impl().start_afresh();
    faults.fail([](std::size_t, const std::string& name, std::size_t) { return name == "clEnqueueNDRangeKernel"; },
                CL_OUT_OF_RESOURCES);
    try {
        pipeline.step(scene);
        FAIL("no kernel ran, yet there is a result");
    } catch (const Error& error) {
        test::check_told(error, "clEnqueueNDRangeKernel", CL_OUT_OF_RESOURCES);
    }
    faults.watch();
    const StepResult& again = pipeline.step(scene);
    CHECK((test::bytes(again.contacts()) == right));
    CHECK(again.report().warnings.empty());
}

TEST_CASE("a device that fails before its first chunk keeps nobody waiting", "[device]") {
    test::Random random(99);
    INFO("seed 99");
    Scene scene = heap(random);
    Context context = test::several(2);
    Faults faults(context);
    context.impl().least_boxes_a_device = 1;
    Pipeline pipeline(context, streaming());
    // Nobody else takes chunks, and few can wait.
    pipeline.impl().phases->forced = {true, 1, 150};
    std::vector<std::string> right(2);
    std::size_t moves = 0;
    const auto move = [&] {
        const std::size_t place = ++moves % 2;
        scene.set_pose({1}, {{4, 4, 4 + 0.5 * static_cast<double>(place)}, {}});
        return place;
    };
    const auto check = [&] {
        const std::size_t place = move();
        const StepResult& result = pipeline.step(scene);
        CHECK((test::bytes(result.contacts()) == right[place]));
        return result.report().warnings.size();
    };
    for (int k = 0; k < 2; ++k) {
        const std::size_t place = move();
        const StepResult& result = pipeline.step(scene);
        REQUIRE(result.report().pairs > 2000);
        right[place] = test::bytes(result.contacts());
    }
    std::vector<std::size_t> calls(2, 0);
    faults.fail(
        [&](std::size_t d, const std::string&, std::size_t) {
            ++calls[d];
            return false;
        },
        CL_SUCCESS);
    CHECK(check() == 0);
    for (std::size_t device = 0; device < 2; ++device)
        for (const std::size_t number : {std::size_t{0}, std::size_t{1}, calls[device] / 2}) {
            INFO("device " << device << " fails at call " << number);
            faults.fail(from_call(device, number), CL_OUT_OF_RESOURCES);
            CHECK(check() == 1);
            faults.watch();
            context.impl().retired.clear();
            CHECK(check() == 0);  // both are at work again
            CHECK(check() == 0);
        }
}
