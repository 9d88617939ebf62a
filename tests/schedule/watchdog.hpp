// Makes a hang of threads a failure that says what hung.
#pragma once

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <future>
#include <thread>
#include <utility>

namespace clinch::test {

/// Runs `body` in another thread and returns when it has; rethrows what it throws. If it has not after two minutes,
/// many thousand times what it needs, the program ends with `what` on standard error: a hung thread cannot be joined.
/// Checks are the caller's, after it: Catch2 takes them from one thread only.
template <class Body>
void or_abort(const char* what, Body body) {
    std::packaged_task<void()> task(std::move(body));
    std::future<void> done = task.get_future();
    std::thread thread(std::move(task));
    if (done.wait_for(std::chrono::minutes(2)) != std::future_status::ready) {
        std::fprintf(stderr, "hung: %s\n", what);
        std::abort();
    }
    thread.join();
    done.get();
}

}  // namespace clinch::test
