// Keeps the entries that are flagged, on a device.
#pragma once

#include <cstdint>

#include "src/device/device.hpp"
#include "src/primitives/scan.hpp"

namespace clinch::detail {

/// Writes the flagged of `n` entries one behind the other, in their order. Keeps its kernels and work memory.
class Compact {
public:
    explicit Compact(Device& device) : device_(device), scan_(device) {}

    /// Enqueues it: out = values[i] of each i < n with flags[i] not 0. All three are uints; `out` holds as many as are
    /// flagged, n at most, and is another buffer than the two others. Cost: reads the flags twice.
    void values(const Buffer& flags, const Buffer& values, std::uint32_t n, const Buffer& out);
    /// The same with the numbers i instead of values.
    void numbers(const Buffer& flags, std::uint32_t n, const Buffer& out);
    /// How many were flagged the last time; waits.
    std::uint32_t count() { return scan_.total(); }

private:
    void run(const Buffer& flags, const Buffer& values, std::uint32_t n, const Buffer& out, bool number);

    Device& device_;
    Scan scan_;
    Kernel count_kernel_, fill_kernel_;
    Buffer counts_, offsets_;
};

}  // namespace clinch::detail
