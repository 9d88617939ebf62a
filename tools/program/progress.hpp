// A progress bar on standard error.
#pragma once

#include <chrono>
#include <string>

namespace clinch::program {

/// Draws itself when standard error is a terminal and the work takes longer than a moment; otherwise
/// prints nothing at all. Takes itself away at its end.
class ProgressBar {
public:
    explicit ProgressBar(std::string what);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// The share done, 0 to 1. Cheap: draws a few times a second at most.
    void show(double share);

private:
    using Clock = std::chrono::steady_clock;
    std::string what_;
    bool terminal_;
    bool drawn_ = false;
    Clock::time_point next_;
};

}  // namespace clinch::program
