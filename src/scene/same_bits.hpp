// Equality of plain values in every bit.
#pragma once

#include <cstring>
#include <type_traits>

namespace clinch::detail {

/// True when two values without padding have the same bytes: a NaN equals itself, -0 is not 0.
template <class T>
bool same_bits(const T& a, const T& b) noexcept {
    static_assert(std::is_trivially_copyable_v<T>, "only bytes are compared");
    const void* const x = &a;
    const void* const y = &b;
    return std::memcmp(x, y, sizeof(T)) == 0;
}

}  // namespace clinch::detail
