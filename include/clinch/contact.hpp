// A contact: where two bodies come nearest to each other, or how deeply one reaches into the other.
#pragma once

#include <cstdint>

#include "clinch/pose.hpp"

namespace clinch {

/// All in world space and the scene's unit of length.
struct Contact {
    std::uint32_t a = 0;  ///< body indices, a < b
    std::uint32_t b = 0;  ///<
    /// Names the features in touch, unique within the pair, and stays the same while they do: 0 the pair's witness
    /// points, else of which of a's and b's corners and edges the point is.
    std::uint32_t feature = 0;
    Vec3 on_a;    ///< on the surface of a: its point nearest to b, or deepest in b
    Vec3 on_b;    ///< the same of b: on_a + distance * normal
    Vec3 normal;  ///< unit length, from a to b
    /// Signed: of disjoint shapes the gap; of overlapping ones minus the shortest translation that separates them.
    double distance = 0.0;
    double error = 0.0;  ///< |distance - true distance| is at most this, always
};

}  // namespace clinch
