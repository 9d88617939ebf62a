// Stable sort of unsigned keys with a payload on a device.
#pragma once

#include <cstdint>

#include "src/device/device.hpp"
#include "src/primitives/scan.hpp"

namespace clinch::detail {

/// Sorts 32- or 64-bit keys, ascending; equal keys keep their order. Keeps its kernels and work memory
/// (as large as keys and payload).
class RadixSort {
public:
    enum class Key { Bits32, Bits64 };
    explicit RadixSort(Device& device, Key key = Key::Bits32) : device_(device), key_(key), scan_(device) {}

    /// Enqueues the sort of the first `n` keys by their lowest `bits` bits; higher ones must be 0. The payload moves
    /// along: what `payload` holds, or, with `number`, each key's place before the sort. Both buffers may be exchanged
    /// for others at least as large. Cost: a pass of two reads and a write for every 8 bits (11 for 16,384 to
    /// 524,288 keys, 4 on devices of one lane).
    void sort(Buffer& keys, Buffer& payload, std::uint32_t n, unsigned bits, bool number);

private:
    Device& device_;
    Key key_;
    Scan scan_;
    Kernel count_kernel_, scatter_kernel_;
    Buffer other_keys_, other_payload_, counts_, offsets_;
};

}  // namespace clinch::detail
