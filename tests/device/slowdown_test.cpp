#include "src/device/slowdown.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/scenes/boxes.hpp"
#include "clinch/broad_phase.hpp"
#include "src/device/context_impl.hpp"
#include "tests/device/devices.hpp"
#include "tests/device/faults.hpp"

using namespace clinch;
using detail::Slowdown;

namespace {

// A time that passes only when it is told to, and what was slept in it.
struct Time {
    double now = 100.0;
    std::vector<double> slept;
    Slowdown::Time ask() {
        return {[this] { return Slowdown::Seconds(now); },
                [this](Slowdown::Seconds time) {
                    slept.push_back(time.count());
                    now += time.count();
                }};
    }
};

}  // namespace

TEST_CASE("a slowdown makes what was waited for so many times as long", "[host]") {
    Time time;
    Slowdown slowdown(4.0, time.ask());
    slowdown.end();  // nothing was given
    CHECK(time.slept.empty());
    slowdown.begin();
    time.now += 1.0;
    slowdown.begin();  // more work, behind the first
    time.now += 1.0;
    slowdown.end();
    CHECK(time.slept == std::vector<double>{6.0});
    time.now += 50.0;  // nothing to do
    slowdown.begin();
    time.now += 0.5;
    slowdown.end();
    slowdown.end();
    CHECK(time.slept == std::vector<double>{6.0, 1.5});
}

TEST_CASE("a slowdown by 1 does nothing", "[host]") {
    Time time;
    for (const double factor : {1.0, 0.5, 0.0}) {
        Slowdown slowdown(factor, time.ask());
        slowdown.begin();
        time.now += 1.0;
        slowdown.end();
    }
    CHECK(time.slept.empty());
}

TEST_CASE("a slowed device sleeps once for each wait, and gives the same", "[device]") {
    Context context(test::first_device());
    const Context::Impl& impl = context.impl();
    Time time;
    const auto doubled = [&](std::optional<Slowdown> slowdown) {
        detail::Device device(impl.infos[0], impl.ids[0], impl.options, {}, std::move(slowdown));
        device.add_module("doubled", "kernel void doubled(global uint* p) { p[get_global_id(0)] *= 2; }\n");
        const std::vector<std::uint32_t> in{3, 5, 7, 11};
        std::vector<std::uint32_t> out(4);
        const detail::Buffer buffer = device.allocate(16, "numbers");
        device.write(buffer, in.data(), 16);
        detail::Kernel kernel = device.kernel("doubled", "doubled");
        device.launch(kernel.args(buffer), 4, 1);
        device.launch(kernel, 4, 1);
        device.finish();
        device.read(buffer, out.data(), 16);
        device.finish();
        const detail::Mapping mapping = device.map(buffer, 16);
        CHECK(std::equal(out.begin(), out.end(), mapping.as<std::uint32_t>()));
        return out;
    };
    const std::vector<std::uint32_t> expected{12, 20, 28, 44};
    CHECK(doubled({}) == expected);
    CHECK(doubled(Slowdown(3.0, time.ask())) == expected);
    CHECK(time.slept.size() == 3);  // at the first finish, the read and the map
}

TEST_CASE("slowed devices find the pairs of others", "[device]") {
    Context context = test::several(2);
    context.impl().least_boxes_a_device = 1;
    BroadPhaseOptions options;
    options.algorithm = "brute";
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", 1000, 5);
    std::string expected;
    {
        BroadPhase broad(context, options);
        expected = test::bytes(broad.find(boxes));
    }
    for (auto& device : context.impl().devices) device.reset();
    context.impl().slowed = {1.0, 2.0};
    BroadPhase broad(context, options);
    CHECK(test::bytes(broad.find(boxes)) == expected);
    CHECK(broad.report().broad_split.size() == 2);
}
