// Boxes and pairs: the input and the output of a broad phase. Kernels share these layouts.
#pragma once

#include <cstdint>
#include <type_traits>

namespace clinch {

/// An axis-aligned box in world space, in the scene's unit of length. Closed: boxes whose faces
/// just touch overlap, and a box of zero width (min = max) is a box. Valid when all six numbers are
/// finite and min <= max on each axis; any other box overlaps nothing and is reported as rejected.
struct Aabb {
    float min[3];
    float max[3];
};

/// Indices of two bodies (or boxes) whose boxes overlap; a < b always.
struct Pair {
    std::uint32_t a;
    std::uint32_t b;
};

static_assert(sizeof(Aabb) == 24 && std::is_trivially_copyable_v<Aabb>, "kernels read this layout");
static_assert(sizeof(Pair) == 8 && std::is_trivially_copyable_v<Pair>, "kernels write this layout");

/// True when the two closed boxes share at least one point; false when either is invalid by NaN.
inline bool overlap(const Aabb& p, const Aabb& q) noexcept {
    return p.min[0] <= q.max[0] && q.min[0] <= p.max[0] && p.min[1] <= q.max[1] && q.min[1] <= p.max[1] &&
           p.min[2] <= q.max[2] && q.min[2] <= p.max[2];
}

/// Ascending by a, then b: the order of sorted results.
inline bool operator<(const Pair& p, const Pair& q) noexcept {
    return p.a != q.a ? p.a < q.a : p.b < q.b;
}
inline bool operator==(const Pair& p, const Pair& q) noexcept {
    return p.a == q.a && p.b == q.b;
}
inline bool operator!=(const Pair& p, const Pair& q) noexcept {
    return !(p == q);
}

}  // namespace clinch
