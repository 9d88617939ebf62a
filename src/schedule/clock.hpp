// Where whoever measures the devices gets the time from: the machine, or a simulated one.
#pragma once

#include <chrono>

namespace clinch::detail {

/// Seconds since some moment in the past; never goes back. Any thread may ask at any time.
class Clock {
public:
    Clock() = default;
    Clock(const Clock&) = delete;
    Clock& operator=(const Clock&) = delete;
    virtual ~Clock() = default;
    virtual double now() const = 0;
};

/// Of the machine the program runs on.
class SteadyClock final : public Clock {
public:
    double now() const override {
        return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    }
};

}  // namespace clinch::detail
