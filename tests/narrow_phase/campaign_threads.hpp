// Work of independent parts on every core.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace clinch::test::campaign {

/// Calls f(0) ... f(parts - 1), each once, in any order, on all cores; f must not throw.
template <class F>
void in_threads(std::size_t parts, const F& f) {
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t i = next++; i < parts; i = next++) f(i);
    };
    std::vector<std::thread> threads;
    const std::size_t cores = std::max<std::size_t>(1, std::thread::hardware_concurrency());
    for (std::size_t i = 1; i < std::min(cores, parts); ++i) threads.emplace_back(work);
    work();
    for (std::thread& thread : threads) thread.join();
}

}  // namespace clinch::test::campaign
