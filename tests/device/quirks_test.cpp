// Each quirk with the smallest kernel that shows it: a device has the quirk exactly if the kernel fails.
#include "src/device/quirks.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>

#include "tests/device/devices.hpp"

using namespace clinch;

namespace {

bool has(const DeviceInfo& info, const std::string& quirk) {
    return std::find(info.quirks.begin(), info.quirks.end(), quirk) != info.quirks.end();
}

}  // namespace

TEST_CASE("quirk loops-end-early: a loop of 70,000 turns is left before its end", "[device]") {
    const Context context = test::all_devices();
    for (std::size_t i = 0; i < context.devices().size(); ++i) {
        detail::Device& device = context.impl().open(i);
        INFO(device.info().name);
        device.add_module("test/loop", R"(
            kernel void loop(global uint* out, uint n) {
                uint turns = 0;
                for (uint k = 0; k < n; ++k) turns += out[1];
                out[0] = turns;
            })");
        detail::Kernel kernel = device.kernel("test/loop", "loop");
        std::uint32_t out[2] = {0, 1};
        const detail::Buffer buffer = device.allocate(sizeof out, "numbers");
        const auto turns = [&](std::uint32_t n) {
            device.write(buffer, out, sizeof out);
            std::uint32_t found = 0;
            device.launch(kernel.args(buffer, n), 1, 1);
            device.read(buffer, &found, sizeof found);
            return found;
        };
        CHECK(turns(60000) == 60000);
        CHECK((turns(70000) != 70000) == has(device.info(), "loops-end-early"));
        CHECK((detail::most_loop_iterations(device.info()) < 70000) == has(device.info(), "loops-end-early"));
    }
}
