// What the bounds stage and the scene's checks need of a shape, found once when the shape is stored.
#pragma once

#include <string>
#include <vector>

#include "clinch/shape.hpp"
#include "src/scene/bounds_shim.hpp"

namespace clinch::detail {

struct ShapeBounds {
    std::string why;  ///< as why_invalid(); if not empty only this and is_plane hold
    bool is_plane = false;
    double reach = 0.0;           ///< no point is farther from the body's origin in 1-norm; 0 for a plane
    ShapeRecord record{};         ///< first_vertex is left 0
    std::vector<float> vertices;  ///< x y z of the outermost points of a hull or mesh
};

/// Cost as why_invalid; for hulls and meshes of more than 32 points also outermost_points().
ShapeBounds shape_bounds(const Shape& shape);

}  // namespace clinch::detail
