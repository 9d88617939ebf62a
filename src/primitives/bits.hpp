// Counting bits.
#pragma once

#include <cstdint>

namespace clinch::detail {

/// Bits that a value needs: one more than the place of its highest bit that is set; of 0 none.
constexpr unsigned bits_of(std::uint64_t value) noexcept {
    unsigned bits = 0;
    for (; value != 0; value >>= 1) ++bits;
    return bits;
}

}  // namespace clinch::detail
