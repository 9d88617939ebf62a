// Benchmarks that end with a message, not the program, when the library throws.
#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <string>

#include "clinch/error.hpp"

namespace clinch::bench {

/// Adds a benchmark of wall time in milliseconds.
inline void add_guarded(const std::string& name, const std::function<void(benchmark::State&)>& body) {
    benchmark::RegisterBenchmark(name.c_str(),
                                 [body](benchmark::State& state) {
                                     try {
                                         body(state);
                                     } catch (const Error& error) {
                                         state.SkipWithError(error.what());
                                     }
                                 })
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
}

}  // namespace clinch::bench
