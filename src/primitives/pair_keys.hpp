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

/// Writes the pairs of keys of a bucket; with `past_caches`, where there is an instruction for it, so that memory that
/// is not read again soon is not first read into the caches. Then end_past_caches() makes them visible to others.
template <bool past_caches>
class KeyUnpacker {
public:
    KeyUnpacker(std::uint32_t bucket, const KeyLayout& layout) noexcept
        : first_(bucket << layout.shift), b_mask_((std::uint32_t{1} << layout.b_bits) - 1), b_bits_(layout.b_bits) {
#if defined(__SSE2__)
        firsts_ = _mm_set1_epi32(static_cast<int>(first_));
        b_masks_ = _mm_set1_epi32(static_cast<int>(b_mask_));
        all_b_bits_ = _mm_cvtsi32_si128(static_cast<int>(b_bits_));
#endif
    }
    /// Keys that must come first so that four() may be called: 0 or 1. `out` begins on a multiple of 8 bytes.
    static std::size_t before_fours(const Pair* out) noexcept {
        return reinterpret_cast<std::uintptr_t>(out) / 8 % 2;
    }
    void one(std::uint32_t key, Pair* out) const noexcept {
        *out = {first_ | (key >> b_bits_), key & b_mask_};
    }
    /// `out` on a multiple of 16 bytes.
    void four(const std::uint32_t* keys, Pair* out) const noexcept {
#if defined(__SSE2__)
        const __m128i k = _mm_loadu_si128(reinterpret_cast<const __m128i*>(keys));
        const __m128i a = _mm_or_si128(firsts_, _mm_srl_epi32(k, all_b_bits_)), b = _mm_and_si128(k, b_masks_);
        store(out, _mm_unpacklo_epi32(a, b));
        store(out + 2, _mm_unpackhi_epi32(a, b));
#else
        for (std::size_t i = 0; i < 4; ++i) one(keys[i], out + i);
#endif
    }
    /// `count` of them; `out` as for before_fours().
    void all(const std::uint32_t* keys, std::size_t count, Pair* out) const noexcept {
        std::size_t i = 0;
        for (; i < count && i < before_fours(out); ++i) one(keys[i], out + i);
        for (; i + 4 <= count; i += 4) four(keys + i, out + i);
        for (; i < count; ++i) one(keys[i], out + i);
    }

private:
    std::uint32_t first_, b_mask_, b_bits_;
#if defined(__SSE2__)
    static void store(Pair* to, __m128i two) noexcept {
        if constexpr (past_caches)
            _mm_stream_si128(reinterpret_cast<__m128i*>(to), two);
        else
            _mm_store_si128(reinterpret_cast<__m128i*>(to), two);
    }
    __m128i firsts_, b_masks_, all_b_bits_;
#endif
};

/// Other threads see what was written past the caches as soon as they see what is written after this.
inline void end_past_caches() noexcept {
#if defined(__SSE2__)
    _mm_sfence();
#endif
}

}  // namespace clinch::detail
