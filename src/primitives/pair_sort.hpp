// Sorts pairs on a device.
#pragma once

#include <cstdint>

#include "src/device/device.hpp"
#include "src/primitives/scan.hpp"

namespace clinch::detail {

/// Ascending by a, then b. Keeps its kernels and work memory: half as much as the pairs, for more than 4,194,304 bodies
/// as much (on devices of one lane for more than 1,048,576).
class PairSort {
public:
    explicit PairSort(Device& device) : device_(device), scan_(device) {}

    /// Enqueues the sort of the first `count` pairs, fewer than 2^32, of numbers below `bodies`; what is behind them
    /// stays. Cost: two reads of the pairs, a write and a read of half as much (as much, for more bodies than named
    /// above), a write of the pairs; and in the caches, where 1/1000 of the pairs fits there, 3 passes over that half
    /// (up to 6 for more bodies). Waits, and sorts on the host, where loops end early.
    void sort(const Buffer& pairs, std::uint64_t count, std::uint32_t bodies);

private:
    struct Kernels {
        Kernel count, scatter, buckets;
    };
    // How many runs count and scatter the pairs, into how many buckets; bits of a below those of the bucket, and of b.
    struct Shape {
        std::uint32_t runs, buckets, shift, b_bits;
        bool packed;  // both fit in 32 bits
    };
    void sort_on_host(const Buffer& pairs, std::uint64_t count);
    Kernels& kernels(bool packed);
    Shape shape_for(std::uint64_t count, std::uint32_t bodies) const;

    Device& device_;
    Scan scan_;
    Kernels packed_, wide_;
    Buffer keys_, counts_, offsets_;
};

}  // namespace clinch::detail
