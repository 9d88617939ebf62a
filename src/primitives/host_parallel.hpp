// Loops over the host's threads, which oneTBB has. They share the cores with OpenCL devices that are CPUs, so threads
// must sleep soon when there is nothing to do: those of GCC's OpenMP go on turning for milliseconds after a loop, and
// wake as late (measured on two cores: 5.8 ms for a loop of 0.5 ms, then 3.7 ms of a core).
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstddef>

namespace clinch::detail {

/// Threads that a loop may have.
inline std::size_t host_threads() {
    return static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
}

/// Calls body(i) for each i < count, spread over the host's threads one by one if `parallel`, in any order. The
/// first exception is thrown again when all threads are done; bodies not yet begun are then left out.
template <class Body>
void parallel_for(std::size_t count, bool parallel, const Body& body) {
    if (!parallel || count < 2) {
        for (std::size_t i = 0; i < count; ++i) body(i);
        return;
    }
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) body(i);
        },
        tbb::simple_partitioner());
}

/// The same for bodies of unlike cost, from `least` of them on: threads take 64 at a time.
template <class Body>
void parallel_blocks(std::size_t count, std::size_t least, const Body& body) {
    constexpr std::size_t block = 64;
    parallel_for((count + block - 1) / block, count >= least, [&](std::size_t b) {
        for (std::size_t i = b * block; i < count && i < (b + 1) * block; ++i) body(i);
    });
}

/// The same for many small bodies, from `least` of them on: each thread has one stretch of them.
template <class Body>
void parallel_rows(std::size_t count, std::size_t least, const Body& body) {
    const auto stretch = [&](const tbb::blocked_range<std::size_t>& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) body(i);
    };
    if (count < least || count < 2)
        stretch({0, count});
    else
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 64), stretch, tbb::static_partitioner());
}

}  // namespace clinch::detail
