// Sorts pairs on a device.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "src/device/device.hpp"
#include "src/primitives/pair_keys.hpp"
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

    /// Whether sort_to_keys() runs on a device: one with lanes, where loops do not end early.
    static bool packs_on(const DeviceInfo& info);
    /// The layout of keys that suits about `pairs` pairs of numbers below `bodies` on a device where sort_to_keys()
    /// runs; none if they do not fit in 32 bits. It is right for any number of pairs on any such device.
    static std::optional<KeyLayout> layout_for(std::uint64_t pairs, std::uint32_t bodies, const DeviceInfo& info);
    /// Sorted pairs as keys, in memory of this sort, until it sorts again.
    struct Packed {
        Mapping keys;
        std::vector<std::uint32_t> starts;  ///< of the buckets, and the end
    };
    /// As sort() of pairs of numbers that fit the layout, but leaves them packed: in place of the write of all pairs,
    /// one of half as much in the caches. What was in `pairs` is lost. Waits.
    Packed sort_to_keys(const Buffer& pairs, std::uint64_t count, const KeyLayout& layout);

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
    std::string defines(bool packed) const;
    static Shape shape_for(std::uint64_t count, std::uint32_t bodies, const DeviceInfo& info);
    void scatter(const Buffer& pairs, std::uint64_t count, const Shape& s);

    Device& device_;
    Scan scan_;
    Kernels packed_, wide_;
    Kernel key_buckets_;
    Buffer keys_, counts_, offsets_;
};

}  // namespace clinch::detail
