#include "tools/program/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <utility>

namespace clinch::program {
namespace {

constexpr std::chrono::milliseconds patience{500}, pause{100};
constexpr double width = 40.0;

}  // namespace

ProgressBar::ProgressBar(std::string what)
    : what_(std::move(what)), terminal_(isatty(STDERR_FILENO) == 1), next_(Clock::now() + patience) {}

ProgressBar::~ProgressBar() {
    if (drawn_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(double share) {
    if (!terminal_ || Clock::now() < next_) return;
    next_ = Clock::now() + pause;
    drawn_ = true;
    const double done = std::clamp(share, 0.0, 1.0);
    const auto filled = static_cast<std::size_t>(done * width);
    const std::string bar = std::string(filled, '#') + std::string(static_cast<std::size_t>(width) - filled, '.');
    std::fprintf(stderr, "\r%s [%s] %3.0f %%", what_.c_str(), bar.c_str(), 100.0 * done);
    std::fflush(stderr);
}

}  // namespace clinch::program
