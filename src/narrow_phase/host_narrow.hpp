// The narrow phase on the host, in float64.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/scene.hpp"
#include "src/narrow_phase/matrix.hpp"
#include "src/narrow_phase/narrow_scene.hpp"
#include "src/narrow_phase/slots.hpp"

namespace clinch::detail {

/// Row of the matrix for a pair; null where there is none: see Slots::group.
const MatrixRow* row_of(const Scene& scene, const NarrowShapes& shapes, const Pair& pair);

/// A row's body for the host's routines; it points into `shapes`.
host::Side host_side(const Scene& scene, const NarrowShapes& shapes, std::uint32_t row);

/// Of each row of the matrix, where iterations may stop (Touch::tolerance of cl/narrow_phase/touch.clh).
using RowTolerances = std::array<double, 32>;

/// Answers for pairs that all have a row, in their order. Several threads above a few hundred pairs.
std::vector<HostAnswer> touch_on_host(const Scene& scene, const NarrowShapes& shapes, View<const Pair> pairs,
                                      const RowTolerances& tolerances);

}  // namespace clinch::detail
