// Loops over the host's threads, which oneTBB has. They share the cores with OpenCL devices that are CPUs, so threads
// must sleep soon when there is nothing to do: those of GCC's OpenMP go on turning for milliseconds after a loop, and
// wake as late (measured on two cores: 5.8 ms for a loop of 0.5 ms, then 3.7 ms of a core).
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <cstddef>
#include <mutex>
#include <vector>

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

/// For work whose place in a result depends on all before it: of each i < count, make(i, room) is called, in any order
/// and on any thread; then place(room), in ascending order of i, one at a time; then put(room), in any order. Threads
/// do not wait for each other. `Room` is work memory of one i, which others use before and after: there are few.
template <class Room, class Make, class Place, class Put>
void parallel_in_order(std::size_t count, const Make& make, const Place& place, const Put& put) {
    std::vector<Room> rooms(2 * host_threads());
    std::vector<Room*> unused;
    unused.reserve(rooms.size());
    for (Room& room : rooms) unused.push_back(&room);
    std::mutex mutex;  // of `unused`
    struct Item {
        std::size_t i;
        Room* room;
    };
    std::size_t next = 0;
    const auto begin = [&](tbb::flow_control& flow) {
        if (next == count) {
            flow.stop();
            return Item{0, nullptr};
        }
        const std::lock_guard<std::mutex> lock(mutex);
        const Item item{next++, unused.back()};
        unused.pop_back();
        return item;
    };
    const auto made = [&](Item item) {
        make(item.i, *item.room);
        return item;
    };
    const auto placed = [&](Item item) {
        place(*item.room);
        return item;
    };
    const auto finish = [&](Item item) {
        put(*item.room);
        const std::lock_guard<std::mutex> lock(mutex);
        unused.push_back(item.room);
    };
    constexpr tbb::filter_mode in_order = tbb::filter_mode::serial_in_order, any = tbb::filter_mode::parallel;
    tbb::parallel_pipeline(
        rooms.size(), tbb::make_filter<void, Item>(in_order, begin) & tbb::make_filter<Item, Item>(any, made) &
                          tbb::make_filter<Item, Item>(in_order, placed) & tbb::make_filter<Item, void>(any, finish));
}

}  // namespace clinch::detail
