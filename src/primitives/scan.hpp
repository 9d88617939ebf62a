// Exclusive scan on a device.
#pragma once

#include <cstdint>

#include "src/device/device.hpp"

namespace clinch::detail {

/// Sums before each value: out[i] = in[0] + ... + in[i - 1]. Keeps its kernels and work memory.
class Scan {
public:
    explicit Scan(Device& device) : device_(device) {}

    /// Enqueues the scan of `n` uints; `out` holds as many. Their sum must be below 2^32. `in` and
    /// `out` are different buffers. Cost: reads in twice, writes out once.
    void exclusive(const Buffer& in, std::uint32_t n, const Buffer& out);
    /// Sum of all values of the last scan; waits for it.
    std::uint32_t total();

private:
    Device& device_;
    Kernel runs_kernel_, sums_kernel_, offsets_kernel_;
    Buffer sums_, total_;
};

}  // namespace clinch::detail
