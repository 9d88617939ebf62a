// Pairs of bodies in given poses, and how far apart they truly are.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "clinch/pose.hpp"
#include "clinch/scene.hpp"
#include "clinch/shape.hpp"

namespace clinch::peers::narrow {

/// What stands at one side of a cell of the algorithm matrix.
struct ShapeKind {
    std::size_t kind = 0;      ///< index of the alternative in clinch::Shape
    std::size_t vertices = 0;  ///< of a hull
};

struct Cell {
    std::string name;
    ShapeKind a, b;
};

/// "box-hull:32": sphere, box, capsule, cylinder, cone, hull:VERTICES (4 to 1024), plane (as the second). Anything else
/// is std::invalid_argument.
Cell cell_of(const std::string& text);

/// How far apart the bodies of a pair are.
enum class Regime {
    Gap,     ///< 0.01 to 0.1 of the pair's size
    Overlap  ///< so deep along one direction; the shortest way out may be a little shorter
};

/// A shape as libraries want it.
struct PoolShape {
    Shape shape;
    /// Of a hull: its triangles, counterclockwise seen from outside, by number of its points, all of which are corners.
    std::vector<std::array<std::uint32_t, 3>> faces;
};

/// The true distance of a pair, and what along.
struct Truth {
    double distance = 0.0, error = 0.0;
    Vec3 normal;
};

/// What is asked of every peer. Pair i is of the bodies 2 i and 2 i + 1. Shapes are about 1 across and shared; bodies
/// lie within 10 of the origin, turned in any way.
struct Batch {
    Cell cell;
    Regime regime = Regime::Gap;
    std::vector<PoolShape> shapes;     ///< those of the first bodies, then those of the second
    std::vector<std::uint32_t> shape;  ///< of a body
    std::vector<Pose> pose;            ///< of a body
    /// Of a pair: the reaches of both shapes from their bodies' origins, together; of a plane, that of the other.
    std::vector<double> size;
    double largest_size = 0.0;
    std::vector<Truth> truth;  ///< of a pair: clinch's routines in float64 on the host, and what they promise
    std::size_t pairs() const { return size.size(); }
};

/// `shapes`: how many different ones on each side. One thread; no OpenCL.
Batch make_batch(const Cell& cell, Regime regime, std::size_t pairs, std::size_t shapes, std::uint64_t seed);

/// The scene of the batch's bodies, each with this margin.
Scene scene_of(const Batch& batch, double margin);

/// Body to world, row-major.
std::array<double, 9> matrix_of(const Quat& rotation);

/// How far a body reaches along n, of about unit length: the greatest n . x. Of a plane along other directions than its
/// own to within 0.03: infinite.
double highest(const Batch& batch, std::size_t body, const Vec3& n);

/// How far some pairs' truths are off, in their sizes, by an oracle that tries all features of both bodies and shares
/// no code with the library.
struct OracleCheck {
    std::size_t pairs = 0;  ///< 0 where a cylinder, cone or plane is among the cell's shapes: those the oracle lacks
    double worst = 0.0;
};

/// Looks at `pairs` pairs, fewer of hulls of many vertices.
OracleCheck check_truth(const Batch& batch, std::size_t pairs);

}  // namespace clinch::peers::narrow
