// Convex hulls of letters and of a torus.
#pragma once

#include <cstddef>

#include "clinch/shape.hpp"

namespace clinch::scenes {

constexpr std::size_t letter_count = 26;

/// The convex hull of a capital letter (0 is A) in a frame around its middle: its outline, 0.9 high (along y) and 0.2
/// to 0.9 wide, extruded to a thickness of 0.2. Every point is a corner. An index past 25 throws std::out_of_range.
Hull letter_hull(std::size_t letter);

/// The convex hull of a torus around the z axis, radius 0.45 + 0.2, of 16 segments: 80 points, each a corner.
Hull torus_hull();

}  // namespace clinch::scenes
