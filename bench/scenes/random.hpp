// Random numbers that are the same on every machine: the standard fixes the engine's output but not
// that of its distributions, nor the last bit of the mathematical functions, so both are made here
// from operations that IEEE 754 rounds exactly.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>

namespace clinch::scenes {

/// A sequence of random numbers that depends on the seed alone.
class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}

    /// Uniform in [0, 1), a multiple of 2^-53.
    double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
    /// Uniform in [low, high].
    double between(double low, double high) { return low + (high - low) * unit(); }
    /// Uniform among 0 .. count - 1 to within 2^-53 * count; count >= 1.
    std::uint64_t below(std::uint64_t count) { return static_cast<std::uint64_t>(unit() * static_cast<double>(count)); }
    /// Mean 0, deviation 1: the sum of 12 uniform numbers less 6, which never leaves [-6, 6].
    double gaussian() {
        double sum = -6.0;
        for (int i = 0; i < 12; ++i) sum += unit();
        return sum;
    }
    /// A unit vector of `Size` numbers, any direction as likely as any other: a point of the unit ball (by rejection,
    /// Marsaglia 1972), stretched. The square root is the one function of <cmath> whose last bit is fixed.
    template <std::size_t Size>
    std::array<double, Size> unit_vector() {
        for (;;) {
            std::array<double, Size> v{};
            double square = 0.0;
            for (double& x : v) {
                x = between(-1.0, 1.0);
                square += x * x;
            }
            if (square > 1.0 || square < 1e-6) continue;
            const double length = std::sqrt(square);
            for (double& x : v) x /= length;
            return v;
        }
    }
    std::array<double, 3> direction() { return unit_vector<3>(); }
    /// A rotation, any as likely as any other: the rows of the matrix of a random unit quaternion.
    std::array<std::array<double, 3>, 3> rotation() {
        const std::array<double, 4> q = unit_vector<4>();
        const double w = q[0], x = q[1], y = q[2], z = q[3];
        return {{{1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)},
                 {2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)},
                 {2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)}}};
    }

private:
    std::mt19937_64 engine_;
};

/// The cube root of x >= 0 by Newton's iteration from above, until it no longer falls.
inline double cube_root(double x) {
    if (!(x > 0.0)) return 0.0;
    for (double root = x > 1.0 ? x : 1.0;;) {
        const double next = (2.0 * root + x / (root * root)) / 3.0;
        if (!(next < root)) return root;
        root = next;
    }
}

}  // namespace clinch::scenes
