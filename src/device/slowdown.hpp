// Makes a device slower than it is, so that tests and benchmarks have devices of unlike speeds where there is one kind.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <thread>
#include <utility>

namespace clinch::detail {

/// Told by a device when it is given work and when that was waited for: the wait is then made as long as it would be on
/// a device that takes `factor` times as long from the first command on. One thread at a time.
class Slowdown {
public:
    using Seconds = std::chrono::duration<double>;
    /// Time and sleep of the machine, or of a test.
    struct Time {
        std::function<Seconds()> now = [] { return Seconds(std::chrono::steady_clock::now().time_since_epoch()); };
        std::function<void(Seconds)> sleep = [](Seconds time) { std::this_thread::sleep_for(time); };
    };

    /// A factor of 1 or less changes nothing.
    explicit Slowdown(double factor) : Slowdown(factor, Time()) {}
    Slowdown(double factor, Time time) : factor_(factor), time_(std::move(time)) {}

    /// A command was given.
    void begin() {
        if (factor_ > 1.0 && !begun_) begun_ = time_.now();
    }
    /// All that was given is done.
    void end() {
        if (!begun_) return;
        time_.sleep((factor_ - 1.0) * (time_.now() - *begun_));
        begun_.reset();
    }

private:
    double factor_;
    Time time_;
    std::optional<Seconds> begun_;
};

}  // namespace clinch::detail
