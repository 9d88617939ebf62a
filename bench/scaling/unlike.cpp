#include "bench/scaling/unlike.hpp"

#include <algorithm>
#include <chrono>
#include <iomanip>
#include <optional>
#include <sstream>
#include <utility>

#include "bench/scenes/bodies.hpp"
#include "bench/scenes/boxes.hpp"
#include "clinch/broad_phase.hpp"
#include "clinch/narrow_phase.hpp"
#include "clinch/pipeline.hpp"
#include "src/device/context_impl.hpp"

namespace clinch::scaling {
namespace {

constexpr double slowed = 4.0;
constexpr int settling = 2, measured = 5, steps = 12;

bool is_pocl_cpu(const DeviceInfo& info) {
    return info.type == DeviceType::Cpu && info.platform == "Portable Computing Language";
}
bool is_basic(const DeviceInfo& info) {
    return info.name.rfind("basic", 0) == 0;
}

// The devices, in contexts of their own: they may be of one device divided, and of another.
class Devices {
public:
    Devices() {
        const std::vector<DeviceInfo> all = list_devices();
        const auto whole = std::find_if(all.begin(), all.end(),
                                        [](const DeviceInfo& info) { return is_pocl_cpu(info) && !is_basic(info); });
        if (whole == all.end()) return;
        ContextOptions options;
        options.use_kernel_cache = false;  // to a driver that is asked for its binaries the two are not the same
        options.devices.indices = {whole->index};
        options.devices.sub_devices = whole->compute_units;
        cores_.emplace(options);
        const auto basic = std::find_if(all.begin(), all.end(),
                                        [](const DeviceInfo& info) { return is_pocl_cpu(info) && is_basic(info); });
        if (basic == all.end()) return;
        options.devices.indices = {basic->index};
        options.devices.sub_devices = 0;
        basic_.emplace(options);
    }
    bool there() const { return basic_ || (cores_ && cores_->devices().size() > 1); }
    // With the first, the second or both, none opened yet.
    Context context(bool first, bool second) const {
        ContextOptions options = cores_->impl().options;
        Context context = Context::host_only();
        context.impl().options = options;
        if (first) add(context, *cores_, 0, 1.0);
        if (second) add(context, basic_ ? *basic_ : *cores_, basic_ ? 0 : 1, slowed);
        // One program of one compiler either way: what tells the two apart is how work is put on threads.
        for (DeviceInfo& info : context.impl().infos) {
            info.name = cores_->devices()[0].name;
            info.version = cores_->devices()[0].version;
        }
        return context;
    }

private:
    static void add(Context& to, const Context& from, std::size_t i, double slow) {
        Context::Impl& impl = to.impl();
        impl.infos.push_back(from.impl().infos[i]);
        impl.ids.push_back(from.impl().ids[i]);
        impl.id_owners.push_back(from.impl().id_owners[i]);
        impl.devices.emplace_back();
        impl.slowed.push_back(slow);
    }
    std::optional<Context> cores_, basic_;
};

template <class Run>
double seconds_of(const Run& run) {
    const auto begin = std::chrono::steady_clock::now();
    run();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// A Load has: make(context), a phase; run(phase); and parts(phase), what each device did in that run.
struct Parts {
    std::array<double, 2> work{}, seconds{};
};

template <class Load>
double alone_seconds(const Load& load, Context context) {
    auto phase = load.make(context);
    std::vector<double> seconds;
    seconds.reserve(settling + measured);
    for (int i = 0; i < settling + measured; ++i) seconds.push_back(seconds_of([&] { load.run(phase); }));
    seconds.erase(seconds.begin(), seconds.begin() + settling);
    std::nth_element(seconds.begin(), seconds.begin() + measured / 2, seconds.end());
    return seconds[measured / 2];
}

template <class Load>
UnlikeCurve curve_of(const std::string& name, std::size_t bodies, const Devices& devices, const Load& load) {
    UnlikeCurve curve{name, static_cast<double>(bodies), {}, 0.0, {}};
    curve.alone_seconds = {alone_seconds(load, devices.context(true, false)),
                           alone_seconds(load, devices.context(false, true))};
    curve.ideal_seconds = 1.0 / (1.0 / curve.alone_seconds[0] + 1.0 / curve.alone_seconds[1]);
    Context both = devices.context(true, true);
    {
        auto builds = load.make(both);
        load.run(builds);
    }
    auto phase = load.make(both);
    for (int i = 0; i < steps; ++i) {
        const double seconds = seconds_of([&] { load.run(phase); });
        const Parts parts = load.parts(phase);
        const double whole = parts.work[0] + parts.work[1];
        curve.steps.push_back({seconds, {parts.work[0] / whole, parts.work[1] / whole}, parts.seconds});
    }
    return curve;
}

struct BroadLoad {
    std::vector<Aabb> boxes;
    BroadPhase make(Context& context) const {
        BroadPhaseOptions options;
        options.algorithm = "bvh";
        return BroadPhase(context, options);
    }
    void run(BroadPhase& broad) const { broad.find(boxes); }
    Parts parts(const BroadPhase& broad) const {
        Parts parts;
        if (broad.report().broad_split.empty()) parts.work[0] = static_cast<double>(boxes.size());
        for (const DeviceWork& work : broad.report().broad_split) {
            parts.work[work.device] = static_cast<double>(work.boxes);
            parts.seconds[work.device] = work.ms / 1e3;
        }
        return parts;
    }
};

struct NarrowLoad {
    Scene scene;
    std::vector<Pair> pairs;
    NarrowPhase make(Context& context) const { return NarrowPhase(context); }
    void run(NarrowPhase& narrow) const { narrow.find(scene, pairs); }
    Parts parts(const NarrowPhase& narrow) const {
        Parts parts;
        for (const DeviceShare& share : narrow.report().devices) {
            parts.work[share.device] = static_cast<double>(share.pairs);
            parts.seconds[share.device] = share.ms / 1e3;
        }
        return parts;
    }
};

NarrowLoad narrow_load(const Devices& devices, std::size_t bodies) {
    NarrowLoad load{scenes::make_bodies("mix", bodies, 1), {}};
    Context context = devices.context(true, false);
    Pipeline pipeline(context);
    const View<const Pair> found = pipeline.step(load.scene).pairs();
    load.pairs.assign(found.begin(), found.end());
    return load;
}

}  // namespace

std::vector<UnlikeCurve> unlike() {
    const Devices devices;
    if (!devices.there()) return {};
    std::vector<UnlikeCurve> curves;
    for (const auto& [kind, count] : {std::pair<const char*, std::size_t>{"density", 1000000}, {"uniform", 200000}})
        curves.push_back(curve_of(std::string("broad phase of ") + kind, count, devices,
                                  BroadLoad{scenes::make_boxes(kind, count, 1)}));
    constexpr std::size_t bodies = 750000;
    curves.push_back(curve_of("narrow phase of mix", bodies, devices, narrow_load(devices, bodies)));
    return curves;
}

// How much longer the slower of the two took than both had with the best split, by what each took in this step.
double of_best_split(const UnlikeStep& step) {
    double speed = 0.0;
    for (std::size_t i = 0; i < 2; ++i)
        if (step.shares[i] > 0.0) speed += step.shares[i] / step.device_seconds[i];
    return std::max(step.device_seconds[0], step.device_seconds[1]) * speed;
}

std::string table(const std::vector<UnlikeCurve>& curves) {
    std::ostringstream text;
    text << std::fixed;
    for (const UnlikeCurve& curve : curves) {
        const auto ms = [](double seconds) { return seconds * 1e3; };
        const double ideal_share = curve.ideal_seconds / curve.alone_seconds[0];
        text << curve.load << ", " << std::setprecision(0) << curve.bodies << ": alone " << std::setprecision(1)
             << ms(curve.alone_seconds[0]) << " and " << ms(curve.alone_seconds[1]) << " ms, ideal "
             << ms(curve.ideal_seconds) << " ms with shares " << std::setprecision(3) << ideal_share << " and "
             << 1.0 - ideal_share << "\n  step      ms  of ideal  shares         devices, ms      of best split\n";
        for (std::size_t i = 0; i < curve.steps.size(); ++i) {
            const UnlikeStep& step = curve.steps[i];
            text << std::setw(6) << i + 1 << std::setprecision(1) << std::setw(8) << ms(step.seconds)
                 << std::setprecision(2) << std::setw(10) << step.seconds / curve.ideal_seconds << std::setprecision(3)
                 << "  " << step.shares[0] << "  " << step.shares[1] << "  " << std::setprecision(1) << std::setw(7)
                 << ms(step.device_seconds[0]) << std::setw(9) << ms(step.device_seconds[1]) << std::setprecision(2)
                 << std::setw(12) << of_best_split(step) << "\n";
        }
    }
    return text.str();
}

}  // namespace clinch::scaling
