// Sorted pairs packed into keys of 32 bits, half as many bytes to move.
#pragma once

#include <cstddef>
#include <cstdint>

#include "clinch/aabb.hpp"
#include "clinch/view.hpp"
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace clinch::detail {

/// Pair (a, b) lies in bucket a >> shift, which has the a from `bucket << shift` on, as the key of the lower `shift`
/// bits of a, then the `b_bits` bits of b; both together are 32 at most. Keys ascend as pairs do.
struct KeyLayout {
    std::uint32_t buckets = 0, shift = 0, b_bits = 0;
    friend bool operator==(const KeyLayout& p, const KeyLayout& q) noexcept {
        return p.buckets == q.buckets && p.shift == q.shift && p.b_bits == q.b_bits;
    }
};

/// Pairs in order, each once: bucket k is keys [starts[k], starts[k + 1]), ascending. No starts: it is none.
struct PairKeys {
    KeyLayout layout;
    View<const std::uint32_t> keys, starts;
    bool any() const noexcept { return !starts.empty(); }
    std::size_t size() const noexcept { return keys.size(); }
};

/// Writes the pairs of `count` keys of a bucket to `out`, which begins on a multiple of 8 bytes; `past_caches`, where
/// there is an instruction for it, so that memory that is not read again soon is not first read into the caches. Then
/// end_past_caches() makes them visible to others.
template <bool past_caches>
void unpack_keys(const std::uint32_t* keys, std::size_t count, std::uint32_t bucket, const KeyLayout& layout,
                 Pair* out) {
    const std::uint32_t first = bucket << layout.shift, b_mask = (std::uint32_t{1} << layout.b_bits) - 1;
    std::size_t i = 0;
    const auto unpack_until = [&](std::size_t end) {
        for (; i < end; ++i) out[i] = {first | (keys[i] >> layout.b_bits), keys[i] & b_mask};
    };
#if defined(__SSE2__)
    // Such stores are of 16 bytes on a multiple of 16.
    unpack_until(count > 0 && reinterpret_cast<std::uintptr_t>(out) % sizeof(__m128i) != 0 ? 1 : 0);
    const __m128i firsts = _mm_set1_epi32(static_cast<int>(first)), mask = _mm_set1_epi32(static_cast<int>(b_mask)),
                  b_bits = _mm_cvtsi32_si128(static_cast<int>(layout.b_bits));
    const auto store = [](Pair* to, __m128i two) {
        if constexpr (past_caches)
            _mm_stream_si128(reinterpret_cast<__m128i*>(to), two);
        else
            _mm_storeu_si128(reinterpret_cast<__m128i*>(to), two);
    };
    for (; i + 4 <= count; i += 4) {
        const __m128i four = _mm_loadu_si128(reinterpret_cast<const __m128i*>(keys + i));
        const __m128i a = _mm_or_si128(firsts, _mm_srl_epi32(four, b_bits)), b = _mm_and_si128(four, mask);
        store(out + i, _mm_unpacklo_epi32(a, b));
        store(out + i + 2, _mm_unpackhi_epi32(a, b));
    }
#endif
    unpack_until(count);
}

/// Other threads see what was written past the caches as soon as they see what is written after this.
inline void end_past_caches() noexcept {
#if defined(__SSE2__)
    _mm_sfence();
#endif
}

}  // namespace clinch::detail
