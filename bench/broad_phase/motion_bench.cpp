// Frames in which few, all or no boxes move, and results too large for a list. Names: motion/<what>/<boxes>:
//   full         every frame a search anew, 1 % of the boxes moving (sorted)
//   update       the same frames through update(), which is told who moved
//   update-any   the same in any order
//   update-events  the same, with the pairs that came and went
//   first        the first update after a search, which begins to keep pairs
//   none         update() when nothing moved
//   all          every box moves 1 % of its side (any order), the tree being refitted
//   step, step-none, step-full  a Pipeline over a Scene of as many cubes: 1 % moved, none, all
// output/<list, any, count, stream>/<boxes>: uniform boxes.
#include <benchmark/benchmark.h>

#include <cmath>
#include <string>
#include <vector>

#include "bench/guarded.hpp"
#include "bench/scenes/boxes.hpp"
#include "bench/scenes/motion.hpp"
#include "clinch/broad_phase.hpp"
#include "clinch/pipeline.hpp"

namespace {

using namespace clinch;
using bench::add_guarded;

enum class Way { Full, Update, UpdateEvents };

void frames(benchmark::State& state, std::size_t n, double fraction, Way way, Order order) {
    scenes::SparseMotion motion(scenes::make_boxes("density", n, 1), fraction, 2);
    Context context;
    BroadPhaseOptions options;
    options.order = order;
    options.events = way == Way::UpdateEvents;
    BroadPhase broad_phase(context, options);
    std::size_t pairs = broad_phase.find(motion.boxes()).size();
    const auto frame = [&] {
        const bool full = way == Way::Full;
        pairs = (full ? broad_phase.find(motion.boxes()) : broad_phase.update(motion.boxes(), motion.movers())).size();
    };
    for (int i = 0; i < 40; ++i) {  // until as many leave their fattened boxes a frame as ever will
        motion.step();
        if (i < 3 || way != Way::Full) frame();
    }
    for (auto _ : state) {
        state.PauseTiming();
        motion.step();
        state.ResumeTiming();
        frame();
    }
    state.counters["pairs"] = static_cast<double>(pairs);
}

void first(benchmark::State& state, std::size_t n) {
    scenes::SparseMotion motion(scenes::make_boxes("density", n, 1), 0.01, 2);
    Context context;
    BroadPhase broad_phase(context);
    for (auto _ : state) {
        state.PauseTiming();
        broad_phase.find(motion.boxes());  // ends what was kept
        motion.step();
        state.ResumeTiming();
        benchmark::DoNotOptimize(broad_phase.update(motion.boxes(), motion.movers()).size());
    }
}

void none(benchmark::State& state, std::size_t n) {
    const std::vector<Aabb> boxes = scenes::make_boxes("density", n, 1);
    Context context;
    BroadPhase broad_phase(context);
    broad_phase.find(boxes);
    for (auto _ : state) benchmark::DoNotOptimize(broad_phase.update(boxes, View<const std::uint32_t>{}).size());
}

void output(benchmark::State& state, std::size_t n, const std::string& how) {
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", n, 1);
    Context context;
    BroadPhaseOptions options;
    options.order = how == "list" ? Order::Sorted : Order::Any;
    BroadPhase broad_phase(context, options);
    std::uint64_t pairs = 0;
    const auto call = [&] {
        if (how == "count") return broad_phase.count(boxes);
        if (how == "stream")
            return broad_phase.stream(boxes, [](View<const Pair> piece) { benchmark::DoNotOptimize(piece.data()); });
        return std::uint64_t{broad_phase.find(boxes).size()};
    };
    pairs = call();
    for (auto _ : state) benchmark::DoNotOptimize(pairs = call());
    state.counters["pairs"] = static_cast<double>(pairs);
}

enum class Sent { Movers, None, All };

void pipeline_frames(benchmark::State& state, std::size_t n, Sent sent) {
    const std::vector<Aabb> boxes = scenes::make_boxes("density", n, 1);
    Scene scene;
    Body body;
    body.shape = scene.add_shape(Box{{0.5, 0.5, 0.5}});
    std::vector<double> positions;
    for (const Aabb& box : boxes) {
        for (int d = 0; d < 3; ++d)
            positions.push_back(0.5 * (static_cast<double>(box.min[d]) + static_cast<double>(box.max[d])));
        body.pose.position = {positions.end()[-3], positions.end()[-2], positions.end()[-1]};
        scene.add_body(body);
    }
    Context context;
    Pipeline pipeline(context);
    std::size_t pairs = pipeline.step(scene).pairs().size();
    int frame = 0;
    const auto move = [&] {  // every 100th body to and fro, 1 % of its side a frame, for 30 frames each way
        const double by = frame / 30 % 2 == 0 ? 0.01 : -0.01;
        for (std::size_t i = 7; i < n && sent == Sent::Movers; i += 100) {
            positions[3 * i + i % 3] += by;
            scene.set_pose({static_cast<std::uint32_t>(i)},
                           {{positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]}, {}});
        }
        if (sent == Sent::All) {
            for (double& x : positions) x += by;
            scene.set_positions(positions.data(), n);
        }
        ++frame;
    };
    for (int i = 0; i < (sent == Sent::Movers ? 60 : 2); ++i) {
        move();
        pipeline.step(scene);
    }
    for (auto _ : state) {
        state.PauseTiming();
        move();
        state.ResumeTiming();
        pairs = pipeline.step(scene).pairs().size();
    }
    state.counters["pairs"] = static_cast<double>(pairs);
}

bool add_all() {
    for (const std::size_t n : {100000u, 1000000u}) {
        const std::string boxes = "/" + std::to_string(n);
        add_guarded("motion/full" + boxes, [=](benchmark::State& s) { frames(s, n, 0.01, Way::Full, Order::Sorted); });
        add_guarded("motion/update" + boxes,
                    [=](benchmark::State& s) { frames(s, n, 0.01, Way::Update, Order::Sorted); });
        add_guarded("motion/update-events" + boxes,
                    [=](benchmark::State& s) { frames(s, n, 0.01, Way::UpdateEvents, Order::Sorted); });
        add_guarded("motion/update-any" + boxes,
                    [=](benchmark::State& s) { frames(s, n, 0.01, Way::Update, Order::Any); });
        add_guarded("motion/first" + boxes, [=](benchmark::State& s) { first(s, n); });
        add_guarded("motion/none" + boxes, [=](benchmark::State& s) { none(s, n); });
        add_guarded("motion/all" + boxes, [=](benchmark::State& s) { frames(s, n, 1.0, Way::Full, Order::Any); });
        add_guarded("motion/step" + boxes, [=](benchmark::State& s) { pipeline_frames(s, n, Sent::Movers); });
        add_guarded("motion/step-none" + boxes, [=](benchmark::State& s) { pipeline_frames(s, n, Sent::None); });
        add_guarded("motion/step-full" + boxes, [=](benchmark::State& s) { pipeline_frames(s, n, Sent::All); });
        for (const char* const how : {"list", "any", "count", "stream"})
            add_guarded(std::string("output/") + how + boxes, [=](benchmark::State& s) { output(s, n, how); });
    }
    return true;
}

[[maybe_unused]] const bool added = add_all();  // beside the benchmarks that main() adds

}  // namespace
