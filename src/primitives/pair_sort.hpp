// Sorts pairs on a device.
#pragma once

#include <cstdint>

#include "src/device/device.hpp"
#include "src/primitives/scan.hpp"

namespace clinch::detail {

/// Ascending by a, then b. Keeps its kernels and work memory (as large as the pairs).
class PairSort {
public:
    explicit PairSort(Device& device) : device_(device), scan_(device) {}

    /// Enqueues the sort of the first `count` pairs, fewer than 2^32, of numbers below `bodies`. The buffer may
    /// be exchanged for another one of the same size. Cost: about 2 + (bits of a and b - 8) / 8 passes over the pairs,
    /// all but two of them in the caches where 1/256 of the pairs fits there. Waits, and sorts on the host, where loops
    /// end early.
    void sort(Buffer& pairs, std::uint64_t count, std::uint32_t bodies);

private:
    void sort_on_host(const Buffer& pairs, std::uint64_t count);

    Device& device_;
    Scan scan_;
    Kernel count_kernel_, scatter_kernel_, buckets_kernel_;
    Buffer other_, counts_, offsets_;
};

}  // namespace clinch::detail
