// The device primitives beside Boost.Compute's on the same device and the standard library's on one core of the host,
// each on 2^20 values: from values on the device (host) to results there. Names: primitives/<what>/<whose>.
// Boost.Compute is a yardstick here; the library itself uses it to talk to OpenCL only.
#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#define BOOST_COMPUTE_THREAD_SAFE  // as the library is built
#define BOOST_COMPUTE_HAVE_THREAD_LOCAL
#include <benchmark/benchmark.h>

#include <algorithm>
#include <boost/compute/algorithm/copy_if.hpp>
#include <boost/compute/algorithm/exclusive_scan.hpp>
#include <boost/compute/algorithm/reduce.hpp>
#include <boost/compute/algorithm/sort_by_key.hpp>
#include <boost/compute/container/vector.hpp>
#include <boost/compute/lambda.hpp>
#include <cstdint>
#include <functional>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "clinch/context.hpp"
#include "clinch/error.hpp"
#include "src/device/context_impl.hpp"
#include "src/device/stopwatch.hpp"
#include "src/primitives/compact.hpp"
#include "src/primitives/radix_sort.hpp"
#include "src/primitives/reduce.hpp"
#include "src/primitives/scan.hpp"

namespace {

using namespace clinch;
namespace compute = boost::compute;

constexpr std::uint32_t values_count = 1u << 20;

template <class T>
std::vector<T> random_values(std::uint64_t below) {
    std::mt19937_64 engine(1);
    std::vector<T> values(values_count);
    for (T& value : values) value = static_cast<T>(below == 0 ? engine() : engine() % below);
    return values;
}

// Times `run` alone, which must leave nothing undone, after `prepare` each time; `right` looks at the last result.
void measure(benchmark::State& state, const std::function<void()>& prepare, const std::function<void()>& run,
             const std::function<bool()>& right) {
    prepare();
    run();  // builds kernels, takes memory
    for (auto _ : state) {
        prepare();
        const detail::Stopwatch watch;
        run();
        state.SetIterationTime(watch.ms() * 1e-3);
    }
    if (!right()) state.SkipWithError("a wrong result");
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * values_count);
}

// The device that the library works on, for both libraries.
struct OnDevice {
    Context context;
    detail::Device& device = context.impl().open(context.impl().primary());
    compute::context compute_context{device.context()};
    compute::command_queue queue{device.queue()};

    template <class T>
    detail::Buffer buffer(const std::vector<T>& values) {
        detail::Buffer made = device.allocate(values.size() * sizeof(T), "values");
        device.write(made, values.data(), values.size() * sizeof(T));
        return made;
    }
    template <class T>
    std::vector<T> read(const detail::Buffer& from, std::size_t count = values_count) {
        std::vector<T> values(count);
        device.read(from, values.data(), count * sizeof(T));
        return values;
    }
    template <class T>
    compute::vector<T> vector(const std::vector<T>& values) {
        return {values.begin(), values.end(), queue};
    }
    template <class T>
    std::vector<T> read(const compute::vector<T>& from) {
        std::vector<T> values(from.size());
        compute::copy(from.begin(), from.end(), values.begin(), queue);
        return values;
    }
};

// --- sort, with a payload of 32 bits

template <class Key>
bool sorted_with(const std::vector<Key>& keys, const std::vector<Key>& sorted,
                 const std::vector<std::uint32_t>& places) {
    bool right = std::is_sorted(sorted.begin(), sorted.end());
    for (std::size_t i = 0; i < keys.size() && right; ++i) right = keys[places[i]] == sorted[i];
    return right;
}

std::vector<std::uint32_t> numbers() {
    std::vector<std::uint32_t> all(values_count);
    std::iota(all.begin(), all.end(), 0u);
    return all;
}

template <class Key>
void sort_clinch(benchmark::State& state) {
    OnDevice on;
    const auto keys = random_values<Key>(0);
    detail::RadixSort sort(on.device,
                           sizeof(Key) == 4 ? detail::RadixSort::Key::Bits32 : detail::RadixSort::Key::Bits64);
    detail::Buffer k = on.buffer(keys), p = on.buffer(numbers());
    measure(
        state,
        [&] {
            on.device.write(k, keys.data(), keys.size() * sizeof(Key));
            on.device.write(p, numbers().data(), values_count * sizeof(std::uint32_t));
        },
        [&] {
            sort.sort(k, p, values_count, 8 * sizeof(Key), false);
            on.device.finish();
        },
        [&] { return sorted_with(keys, on.read<Key>(k), on.read<std::uint32_t>(p)); });
}

template <class Key>
void sort_boost(benchmark::State& state) {
    OnDevice on;
    const auto keys = random_values<Key>(0);
    const auto payload = numbers();
    compute::vector<Key> k = on.vector(keys);
    compute::vector<std::uint32_t> p = on.vector(payload);
    measure(
        state,
        [&] {
            compute::copy(keys.begin(), keys.end(), k.begin(), on.queue);
            compute::copy(payload.begin(), payload.end(), p.begin(), on.queue);
        },
        [&] {
            compute::sort_by_key(k.begin(), k.end(), p.begin(), on.queue);
            on.queue.finish();
        },
        [&] { return sorted_with(keys, on.read(k), on.read(p)); });
}

template <class Key>
void sort_std(benchmark::State& state) {
    using Row = std::pair<Key, std::uint32_t>;
    const auto keys = random_values<Key>(0);
    std::vector<Row> rows(values_count);
    measure(
        state,
        [&] {
            for (std::uint32_t i = 0; i < values_count; ++i) rows[i] = {keys[i], i};
        },
        [&] { std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.first < b.first; }); },
        [&] {
            return std::is_sorted(rows.begin(), rows.end(),
                                  [](const Row& a, const Row& b) { return a.first < b.first; });
        });
}

// --- exclusive scan

std::vector<std::uint32_t> scanned(const std::vector<std::uint32_t>& values) {
    std::vector<std::uint32_t> sums(values.size());
    std::exclusive_scan(values.begin(), values.end(), sums.begin(), 0u);
    return sums;
}

void scan_clinch(benchmark::State& state) {
    OnDevice on;
    const auto values = random_values<std::uint32_t>(7);
    detail::Scan scan(on.device);
    const detail::Buffer in = on.buffer(values), out = on.buffer(values);
    measure(
        state, [] {},
        [&] {
            scan.exclusive(in, values_count, out);
            on.device.finish();
        },
        [&] { return on.read<std::uint32_t>(out) == scanned(values); });
}

void scan_boost(benchmark::State& state) {
    OnDevice on;
    const auto values = random_values<std::uint32_t>(7);
    const compute::vector<std::uint32_t> in = on.vector(values);
    compute::vector<std::uint32_t> out = on.vector(values);
    measure(
        state, [] {},
        [&] {
            compute::exclusive_scan(in.begin(), in.end(), out.begin(), 0u, on.queue);
            on.queue.finish();
        },
        [&] { return on.read(out) == scanned(values); });
}

void scan_std(benchmark::State& state) {
    const auto values = random_values<std::uint32_t>(7);
    std::vector<std::uint32_t> out(values_count);
    measure(
        state, [] {}, [&] { std::exclusive_scan(values.begin(), values.end(), out.begin(), 0u); },
        [&] { return out == scanned(values); });
}

// --- sum

void sum_clinch(benchmark::State& state) {
    OnDevice on;
    const auto values = random_values<std::uint32_t>(7);
    detail::Reduce sum(on.device, detail::Reduce::Operation::Sum, detail::Reduce::Value::Uint);
    const detail::Buffer in = on.buffer(values);
    std::uint32_t total = 0;
    measure(
        state, [] {},
        [&] {
            sum.run(in, values_count);
            total = sum.as_uint();
        },
        [&] { return total == std::accumulate(values.begin(), values.end(), 0u); });
}

void sum_boost(benchmark::State& state) {
    OnDevice on;
    const auto values = random_values<std::uint32_t>(7);
    const compute::vector<std::uint32_t> in = on.vector(values);
    std::uint32_t total = 0;
    measure(
        state, [] {}, [&] { compute::reduce(in.begin(), in.end(), &total, compute::plus<std::uint32_t>(), on.queue); },
        [&] { return total == std::accumulate(values.begin(), values.end(), 0u); });
}

void sum_std(benchmark::State& state) {
    const auto values = random_values<std::uint32_t>(7);
    std::uint32_t total = 0;
    measure(
        state, [] {}, [&] { benchmark::DoNotOptimize(total = std::accumulate(values.begin(), values.end(), 0u)); },
        [&] { return total == std::accumulate(values.begin(), values.end(), 0u); });
}

// --- compaction: the values that are not 0, one in eight

std::vector<std::uint32_t> sparse_values() {
    std::vector<std::uint32_t> values = random_values<std::uint32_t>(8);
    for (std::uint32_t i = 0; i < values_count; ++i) values[i] = values[i] == 0 ? i + 1 : 0;
    return values;
}

std::vector<std::uint32_t> compacted(const std::vector<std::uint32_t>& values) {
    std::vector<std::uint32_t> kept;
    std::copy_if(values.begin(), values.end(), std::back_inserter(kept), [](std::uint32_t v) { return v != 0; });
    return kept;
}

void compact_clinch(benchmark::State& state) {
    OnDevice on;
    const auto values = sparse_values();
    detail::Compact compact(on.device);
    const detail::Buffer in = on.buffer(values), out = on.buffer(values);
    measure(
        state, [] {},
        [&] {
            compact.values(in, in, values_count, out);
            on.device.finish();
        },
        [&] { return on.read<std::uint32_t>(out, compact.count()) == compacted(values); });
}

void compact_boost(benchmark::State& state) {
    OnDevice on;
    const auto values = sparse_values();
    const compute::vector<std::uint32_t> in = on.vector(values);
    compute::vector<std::uint32_t> out = on.vector(values);
    std::size_t kept = 0;
    measure(
        state, [] {},
        [&] {
            const auto end = compute::copy_if(in.begin(), in.end(), out.begin(), compute::lambda::_1 != 0u, on.queue);
            kept = static_cast<std::size_t>(std::distance(out.begin(), end));
            on.queue.finish();
        },
        [&] {
            std::vector<std::uint32_t> found = on.read(out);
            found.resize(kept);
            return found == compacted(values);
        });
}

void compact_std(benchmark::State& state) {
    const auto values = sparse_values();
    std::vector<std::uint32_t> out;
    measure(
        state, [&] { out.clear(); },
        [&] { std::copy_if(values.begin(), values.end(), std::back_inserter(out), [](auto v) { return v != 0; }); },
        [&] { return out == compacted(values); });
}

using Body = void (*)(benchmark::State&);

bool add_all() {
    const std::pair<const char*, Body> all[] = {
        {"sort32/clinch", sort_clinch<std::uint32_t>},
        {"sort32/boost-compute", sort_boost<std::uint32_t>},
        {"sort32/std", sort_std<std::uint32_t>},
        {"sort64/clinch", sort_clinch<std::uint64_t>},
        {"sort64/boost-compute", sort_boost<cl_ulong>},
        {"sort64/std", sort_std<std::uint64_t>},
        {"scan/clinch", scan_clinch},
        {"scan/boost-compute", scan_boost},
        {"scan/std", scan_std},
        {"sum/clinch", sum_clinch},
        {"sum/boost-compute", sum_boost},
        {"sum/std", sum_std},
        {"compact/clinch", compact_clinch},
        {"compact/boost-compute", compact_boost},
        {"compact/std", compact_std},
    };
    for (const auto& [name, body] : all) {
        const auto guarded = [body = body](benchmark::State& state) {
            try {
                body(state);
            } catch (const std::exception& error) {  // of either library
                state.SkipWithError(error.what());
            }
        };
        benchmark::RegisterBenchmark((std::string("primitives/") + name).c_str(), guarded)
            ->UseManualTime()
            ->Unit(benchmark::kMillisecond);
    }
    return true;
}

[[maybe_unused]] const bool added = add_all();  // beside the benchmarks that main() adds

}  // namespace
