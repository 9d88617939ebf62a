// The triangles of a convex hull, for libraries that want them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "clinch/pose.hpp"

namespace clinch::peers::narrow {

/// Counterclockwise seen from outside. Points that Qhull can make no hull of, or one of which is no corner of it, are
/// std::runtime_error.
std::vector<std::array<std::uint32_t, 3>> hull_faces(const std::vector<Vec3>& points);

}  // namespace clinch::peers::narrow
