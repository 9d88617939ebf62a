// The memory that a search takes on a device stays within what is promised, and is reported.
#include <catch2/catch.hpp>

#include "bench/scenes/boxes.hpp"
#include "bench/scenes/motion.hpp"
#include "clinch/broad_phase.hpp"
#include "tests/device/devices.hpp"

using namespace clinch;

TEST_CASE("device memory stays below 96 bytes a body and 24 a pair, 12 in any order", "[device]") {
    constexpr std::size_t n = 20000, fixed = std::size_t{1} << 20;
    for (std::uint32_t device = 0; device < list_devices().size(); ++device)
        for (const std::string name : {"bvh", "grid", "sweep"}) {
            // Where loops end early many more work-items are needed, each with room for pairs of its own.
            if (!list_devices()[device].quirks.empty()) continue;
            for (const char* const kind : {"density", "uniform", "mixed", "line"})
                for (const Order order : {Order::Sorted, Order::Any}) {
                    INFO(name << " " << kind << " device " << device);
                    const std::vector<Aabb> boxes = scenes::make_boxes(kind, n, 1);
                    ContextOptions of_device;
                    of_device.devices.indices.assign(1, device);
                    Context context(of_device);
                    BroadPhaseOptions options;
                    options.algorithm = name;
                    options.order = order;
                    BroadPhase broad_phase(context, options);
                    const std::size_t pairs = broad_phase.find(boxes).size();
                    broad_phase.find(boxes);
                    const std::size_t most = n * 96 + pairs * (order == Order::Any ? 12 : 24) + fixed;
                    CHECK(broad_phase.report().peak_device_bytes > n * 24);
                    CHECK(broad_phase.report().peak_device_bytes < most);
                }
        }
}

TEST_CASE("device memory stays below that while pairs are kept", "[device]") {
    constexpr std::size_t n = 40000, fixed = std::size_t{1} << 20;
    for (std::uint32_t device = 0; device < list_devices().size(); ++device) {
        if (!list_devices()[device].quirks.empty()) continue;
        for (const char* const kind : {"density", "uniform", "mixed", "grid-touch"})
            for (const Order order : {Order::Sorted, Order::Any}) {
                scenes::SparseMotion motion(scenes::make_boxes(kind, n, 1), 0.01, 1);
                ContextOptions of_device;
                of_device.devices.indices.assign(1, device);
                Context context(of_device);
                BroadPhaseOptions options;
                options.order = order;
                BroadPhase broad_phase(context, options);
                broad_phase.find(motion.boxes());
                std::size_t pairs = 0;
                for (int frame = 0; frame < 12; ++frame) {
                    motion.step();
                    pairs = broad_phase.update(motion.boxes(), motion.movers()).size();
                }
                INFO(kind << " device " << device << " pairs " << pairs);
                CHECK(broad_phase.report().algorithm == "incremental");
                const std::size_t most = motion.boxes().size() * 96 + pairs * (order == Order::Any ? 12 : 24) + fixed;
                CHECK(broad_phase.report().peak_device_bytes > n * 24);
                CHECK(broad_phase.report().peak_device_bytes < most);
            }
    }
}

TEST_CASE("host memory of lists is reported", "[host]") {
    Context context = Context::host_only();
    BroadPhase broad_phase(context);
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", 3000, 1);
    const std::size_t pairs = broad_phase.find(boxes).size();
    CHECK(broad_phase.report().peak_host_bytes >= pairs * sizeof(Pair));
    CHECK(broad_phase.count(boxes) == pairs);
    CHECK(broad_phase.report().peak_host_bytes >= pairs * sizeof(Pair));
}
