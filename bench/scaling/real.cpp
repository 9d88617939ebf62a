// The CPU's own parts as devices: 1, 2, ... of the sub-devices that it can be divided into.
#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "bench/cpu_parts.hpp"
#include "bench/scaling/curve.hpp"
#include "bench/scenes/bodies.hpp"
#include "bench/scenes/boxes.hpp"
#include "clinch/broad_phase.hpp"
#include "clinch/narrow_phase.hpp"
#include "clinch/pipeline.hpp"

namespace clinch::scaling {
namespace {

constexpr int settling = 6, measured = 15;

// The median of several runs, in seconds, after some that build kernels and settle the shares.
template <class Run>
double seconds_of(const Run& run) {
    std::vector<double> seconds;
    for (int i = 0; i < settling + measured; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        run();
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
        if (i >= settling) seconds.push_back(took.count());
    }
    std::nth_element(seconds.begin(), seconds.begin() + measured / 2, seconds.end());
    return seconds[measured / 2];
}

template <class At>
Curve curve_of(const DeviceInfo& whole, const std::string& load, std::size_t bodies, std::size_t most, const At& at) {
    Curve curve{load, "one core each", static_cast<double>(bodies), {}};
    for (std::size_t devices = 1; devices <= std::min<std::size_t>(most, whole.compute_units); ++devices) {
        Context context = bench::parts_of(whole, devices);
        Point point = at(context);
        point.devices = devices;
        point.ideal_seconds =
            (curve.points.empty() ? point.seconds : curve.points[0].seconds) / static_cast<double>(devices);
        curve.points.push_back(point);
    }
    return curve;
}

Curve broad(const DeviceInfo& whole, const std::string& kind, std::size_t n, std::size_t most) {
    const std::vector<Aabb> boxes = scenes::make_boxes(kind, n, 1);
    return curve_of(whole, "broad phase of " + kind, n, most, [&](Context& context) {
        BroadPhaseOptions options;
        options.algorithm = "bvh";
        BroadPhase broad_phase(context, options);
        return Point{0, seconds_of([&] { broad_phase.find(boxes); }), 0.0, 0.0};
    });
}

Curve narrow(const DeviceInfo& whole, std::size_t n, std::size_t most) {
    const Scene scene = scenes::make_bodies("mix", n, 1);
    Context context = bench::parts_of(whole, 1);
    Pipeline pipeline(context);
    const View<const Pair> found = pipeline.step(scene).pairs();
    const std::vector<Pair> pairs(found.begin(), found.end());
    return curve_of(whole, "narrow phase of mix", n, most, [&](Context& devices) {
        NarrowPhase narrow_phase(devices);
        Point point{0, seconds_of([&] { narrow_phase.find(scene, pairs); }), 0.0, 0.0};
        std::uint64_t chunks = 0, stolen = 0;
        for (const DeviceShare& share : narrow_phase.report().devices) {
            chunks += share.chunks;
            stolen += share.stolen;
        }
        if (chunks > 0) point.stolen = static_cast<double>(stolen) / static_cast<double>(chunks);
        return point;
    });
}

}  // namespace

std::optional<Machine> real(std::size_t most) {
    const std::optional<DeviceInfo> cpu = bench::largest_cpu();
    if (!cpu) return {};
    return Machine{
        "real",
        cpu->name + ", " + std::to_string(cpu->compute_units) + " compute units",
        {},
        {broad(*cpu, "density", 1000000, most), broad(*cpu, "uniform", 500000, most), narrow(*cpu, 750000, most)}};
}

}  // namespace clinch::scaling
