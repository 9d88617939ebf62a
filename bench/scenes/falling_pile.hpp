// The pile in which falling bodies come to rest, and the cloud above it in which they start.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bench/scenes/falling_plan.hpp"
#include "bench/scenes/random.hpp"

namespace clinch::scenes {

/// Columns on a square lattice, filled from the lowest place up.
struct Pile {
    double pitch, layer;  ///< between columns, and between the layers of one
    double tilt;          ///< at most, as the tangent of half the angle; about z bodies are turned at random
};
struct Column {
    double x, y, floor;
    std::uint32_t colour;  ///< 0 to 3; no two neighbours have the same
};

/// A scene of `count` bodies in the making.
struct Draft {
    FallPlan plan;
    std::vector<ShapeId> shapes;  ///< of the fallers, one for each outline
    Random random;
    std::size_t count;

    void add_static(ShapeId shape, const Pose& pose);
    /// Adds a shape for fallers to take at random.
    void add_shape(Shape shape, Outline outline);
    /// The largest bound of an outline.
    double bound() const;
};

/// edge^2 columns around the origin, on the floor z = 0.
std::vector<Column> square_of_columns(std::size_t edge, double pitch);

/// Adds the bodies that are still missing, at least one column for them: each has a place in the pile, and starts above
/// it and above `above`, those of one column far apart, those of neighbours at other heights, so that few overlap at
/// first. Sets the gravity that takes the highest down in fall_frames.
void fill(Draft& draft, const std::vector<Column>& columns, const Pile& pile, double above);

}  // namespace clinch::scenes
