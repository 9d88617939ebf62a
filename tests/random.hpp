// Random numbers for tests: the same on every machine.
#pragma once

#include <cstdint>
#include <random>

namespace clinch::test {

class Random {
public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    std::uint64_t bits() { return engine_(); }
    /// Uniform in [0, n), n > 0.
    std::uint64_t below(std::uint64_t n) { return engine_() % n; }
    /// Uniform in [low, high).
    double between(double low, double high) {
        return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
    }

private:
    std::mt19937_64 engine_;
};

}  // namespace clinch::test
