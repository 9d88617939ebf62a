// Float64 to float32 on the safe side, and clear of numbers that a device could flush to zero.
#pragma once

#include <cmath>
#include <limits>

namespace clinch::detail {

/// Lengths sent to a device are 0 or at least this: see cl/common/bounds.clh, point 5.
constexpr float smallest_length = 0x1p-90f;

/// The smallest float32 that is not below x; x is at most float32's largest number.
inline float round_up(double x) {
    const auto f = static_cast<float>(x);
    return static_cast<double>(f) < x ? std::nextafter(f, std::numeric_limits<float>::infinity()) : f;
}

/// As round_up, for x >= 0: 0 stays 0, other lengths become at least smallest_length.
inline float length_up(double x) {
    const float f = round_up(x);
    return x > 0.0 && f < smallest_length ? smallest_length : f;
}

}  // namespace clinch::detail
