// A closed surface with bumps, cut into triangles: what a deforming body's boxes look like.
#pragma once

#include <array>
#include <cstdint>

#include "bench/scenes/random.hpp"
#include "clinch/aabb.hpp"

namespace clinch::scenes {

/// A cube whose six faces are grids of 2 m^2 triangles, blown up to a sphere with bumps of up to 15 % of its
/// radius. Edges are about 1 long at any number of triangles. Neighbours share their corners to the last bit.
class BumpySurface {
public:
    using Point = std::array<double, 3>;

    BumpySurface() = default;
    /// `triangles` of a surface around `middle`, of the smallest m that has as many; the few that it has more are
    /// left out evenly. Draws the bumps from `random`.
    BumpySurface(Random& random, std::uint64_t triangles, const Point& middle);

    /// The mean radius of a surface of this many triangles.
    static double radius(std::uint64_t triangles);

    /// The box of triangle k < triangles, corners rounded to the nearest float32. Neighbours in k are mostly
    /// neighbours on the surface. O(1).
    Aabb triangle_box(std::uint64_t k) const;

private:
    static std::uint64_t cells_across(std::uint64_t triangles);
    Point corner(std::uint64_t face, std::uint64_t column, std::uint64_t row) const;

    std::uint64_t triangles_ = 0;
    std::uint64_t cells_ = 1;  // m: cells along an edge of the cube
    double radius_ = 0.0;
    Point middle_{};
    Point phase_{};
};

}  // namespace clinch::scenes
