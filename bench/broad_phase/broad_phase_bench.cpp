// Every algorithm of the registry on every kind of scene, from boxes in host memory to sorted pairs readable there;
// beside them, for brute force, one core of plain C++ and the thesis' own formulation. Names:
// broad/<algorithm>/<kind>/<boxes>, yardstick/plain-loop/..., baseline/thesis-brute/...
#include <benchmark/benchmark.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "bench/broad_phase/plain_loop.hpp"
#include "bench/guarded.hpp"
#include "bench/scenes/boxes.hpp"
#include "clinch/broad_phase.hpp"
#include "src/device/context_impl.hpp"

namespace {

using namespace clinch;
using bench::add_guarded;

void count(benchmark::State& state, std::uint64_t boxes, std::uint64_t pairs) {
    const double tests = 0.5 * static_cast<double>(boxes) * static_cast<double>(boxes - 1);
    state.counters["pairs"] = static_cast<double>(pairs);
    state.counters["all_pairs_per_s"] = benchmark::Counter(tests, benchmark::Counter::kIsIterationInvariantRate);
}

void broad(benchmark::State& state, const std::string& algorithm, const std::string& kind, std::size_t n) {
    const std::vector<Aabb> boxes = scenes::make_boxes(kind, n, 1);
    Context context;
    BroadPhaseOptions options;
    options.algorithm = algorithm;
    BroadPhase broad_phase(context, options);
    std::uint64_t pairs = broad_phase.find(boxes).size();  // builds kernels, takes memory
    for (auto _ : state) benchmark::DoNotOptimize(pairs = broad_phase.find(boxes).size());
    count(state, n, pairs);
}

void plain_loop(benchmark::State& state, const std::string& kind, std::size_t n) {
    const std::vector<Aabb> boxes = scenes::make_boxes(kind, n, 1);
    std::vector<float> columns[6];
    for (const Aabb& box : boxes)
        for (std::size_t d = 0; d < 3; ++d) {
            columns[d].push_back(box.min[d]);
            columns[d + 3].push_back(box.max[d]);
        }
    std::uint64_t pairs = 0;
    for (auto _ : state) benchmark::DoNotOptimize(pairs = bench::count_overlaps(columns, n));
    count(state, n, pairs);
}

std::string thesis_source() {
    std::ifstream file(CLINCH_BENCH_DIR "/broad_phase/thesis_brute.cl");
    return {std::istreambuf_iterator<char>(file), {}};
}

void thesis(benchmark::State& state, const std::string& kind, std::size_t n) {
    const std::vector<Aabb> boxes = scenes::make_boxes(kind, n, 1);
    const Context context;
    detail::Device& device = context.impl().open(context.impl().primary());
    device.add_module("bench/thesis_brute", thesis_source());
    detail::Kernel test = device.kernel("bench/thesis_brute", "thesis_brute");
    detail::Kernel sum = device.kernel("bench/thesis_brute", "thesis_count");
    const std::uint64_t all = std::uint64_t{n} * (n - 1) / 2;
    const auto words = static_cast<std::uint32_t>(all / 32 + 1);
    const detail::Buffer rows = device.allocate(n * sizeof(Aabb), "boxes"),
                         bits = device.allocate(std::size_t{words} * 4, "bits"),
                         total = device.allocate(4, "the count");
    std::uint32_t pairs = 0;
    const auto run = [&] {
        device.write(rows, boxes.data(), n * sizeof(Aabb));
        device.clear(bits, std::size_t{words} * 4);
        device.clear(total, 4);
        device.launch_items(test.args(rows, static_cast<std::uint32_t>(n), bits), all);
        device.launch_items(sum.args(bits, words, words / 256 + 1, total), 256);
        device.read(total, &pairs, 4);
    };
    run();
    for (auto _ : state) run();
    count(state, n, pairs);
}

// Takes seconds to minutes a call for 100,000 boxes of some kinds.
bool slow(const std::string& algorithm) {
    return algorithm == "host-brute" || algorithm == "sweep3";
}

void add_all() {
    for (const scenes::BoxKind& kind : scenes::box_kinds())
        for (const std::size_t n : {1000u, 10000u, 100000u}) {
            if (kind.all_pairs && n > 1000) continue;
            const std::string scene = std::string(kind.name) + "/" + std::to_string(n);
            for (const std::string& algorithm : broad_phase_names())
                if (n <= 10000 || !slow(algorithm))
                    add_guarded("broad/" + algorithm + "/" + scene,
                                [=](benchmark::State& state) { broad(state, algorithm, kind.name, n); });
        }
    for (const std::size_t n : {1000u, 10000u}) {
        const std::string scene = "uniform/" + std::to_string(n);
        add_guarded("yardstick/plain-loop/" + scene, [=](benchmark::State& state) { plain_loop(state, "uniform", n); });
        add_guarded("baseline/thesis-brute/" + scene, [=](benchmark::State& state) { thesis(state, "uniform", n); });
    }
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    add_all();
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
