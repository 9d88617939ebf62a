// Makes a hang a failure that says what hung.
#pragma once

#include <catch2/catch.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <future>
#include <string>
#include <thread>
#include <utility>

namespace clinch::test {

/// While it lives, a time runs: when it is up, the program ends with the running test's name on standard error, since
/// what hangs cannot be ended otherwise. A guard against hangs alone: ten minutes are some hundred times what anything
/// guarded needs, on a slow machine, too. Made and ended in the thread of the test.
class Watchdog {
public:
    using Late = std::function<void(const std::string& test)>;

    /// `late` is called when the time is up, on a thread of its own.
    explicit Watchdog(std::chrono::minutes limit = std::chrono::minutes(10), Late late = end_program)
        : thread_([test = Catch::getResultCapture().getCurrentTestName(), over = over_.get_future(), limit,
                   late = std::move(late)] {
              if (over.wait_for(limit) != std::future_status::ready) late(test);
          }) {}
    ~Watchdog() {
        over_.set_value();
        thread_.join();
    }
    Watchdog(const Watchdog&) = delete;
    Watchdog& operator=(const Watchdog&) = delete;

private:
    static void end_program(const std::string& test) {
        std::fprintf(stderr, "hung: the test '%s'\n", test.c_str());
        std::abort();
    }
    std::promise<void> over_;
    std::thread thread_;
};

}  // namespace clinch::test
