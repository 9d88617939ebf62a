#include "bench/scenes/surface.hpp"

#include <algorithm>
#include <cmath>

namespace clinch::scenes {
namespace {

/// From -1 to 1 with period 1, smooth, without the last bits of a sine.
double wave(double t) {
    const double u = t - std::floor(t);
    const double v = u * (1.0 - u);
    return 1.0 - 32.0 * v * v;
}

}  // namespace

std::uint64_t BumpySurface::cells_across(std::uint64_t triangles) {
    auto m = static_cast<std::uint64_t>(std::sqrt(static_cast<double>(triangles) / 12.0));
    while (12 * m * m < triangles) ++m;
    return std::max<std::uint64_t>(m, 1);
}

// 12 m^2 triangles of area 1/2 cover a sphere of this radius.
double BumpySurface::radius(std::uint64_t triangles) {
    return 0.69098829894267096 * static_cast<double>(cells_across(triangles));
}

BumpySurface::BumpySurface(Random& random, std::uint64_t triangles, const Point& middle)
    : triangles_(triangles), cells_(cells_across(triangles)), radius_(radius(triangles)), middle_(middle) {
    for (double& phase : phase_) phase = random.unit();
}

// A corner on the edge of two faces has the same three coordinates seen from either.
BumpySurface::Point BumpySurface::corner(std::uint64_t face, std::uint64_t column, std::uint64_t row) const {
    const double m = static_cast<double>(cells_);
    const std::size_t axis = face % 3;
    Point p{};
    p[axis] = face < 3 ? -1.0 : 1.0;
    p[(axis + 1) % 3] = 2.0 * static_cast<double>(column) / m - 1.0;
    p[(axis + 2) % 3] = 2.0 * static_cast<double>(row) / m - 1.0;
    const double length = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    double bumps = 0.0;
    for (std::size_t d = 0; d < 3; ++d) {
        p[d] /= length;
        bumps += wave(2.0 * p[d] + phase_[d]);
    }
    const double reach = radius_ * (1.0 + 0.05 * bumps);
    for (std::size_t d = 0; d < 3; ++d) p[d] = middle_[d] + reach * p[d];
    return p;
}

Aabb BumpySurface::triangle_box(std::uint64_t k) const {
    const std::uint64_t triangle = k * (12 * cells_ * cells_) / triangles_;
    const std::uint64_t half = triangle % 2, cell = triangle / 2;
    const std::uint64_t column = cell % cells_, row = cell / cells_ % cells_, face = cell / cells_ / cells_;
    const std::array<Point, 3> corners{corner(face, column + half, row + half), corner(face, column + 1, row),
                                       corner(face, column, row + 1)};
    Aabb box{};
    for (std::size_t d = 0; d < 3; ++d) {
        const auto [low, high] = std::minmax({corners[0][d], corners[1][d], corners[2][d]});
        box.min[d] = static_cast<float>(low);
        box.max[d] = static_cast<float>(high);
    }
    return box;
}

}  // namespace clinch::scenes
