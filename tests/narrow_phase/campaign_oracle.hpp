// What is certain of two bodies' distance, from formulas and certificates that share nothing with the routines: cheap
// enough for millions of pairs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "clinch/shape.hpp"
#include "tests/random.hpp"

namespace clinch::test::campaign {

template <class R>
struct Vector {
    R x{}, y{}, z{};
    Vector operator+(const Vector& o) const { return {x + o.x, y + o.y, z + o.z}; }
    Vector operator-(const Vector& o) const { return {x - o.x, y - o.y, z - o.z}; }
    Vector operator-() const { return {-x, -y, -z}; }
    Vector operator*(R s) const { return {x * s, y * s, z * s}; }
    R dot(const Vector& o) const { return x * o.x + y * o.y + z * o.z; }
    Vector cross(const Vector& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
    template <class S>
    Vector<S> as() const {
        return {static_cast<S>(x), static_cast<S>(y), static_cast<S>(z)};
    }
};

using Real = long double;
using Real3 = Vector<Real>;

/// Also where squares vanish or overflow.
Real length(const Real3& v);
/// v / |v|, or z where v is 0.
Real3 unit(const Real3& v);

/// Classes by number: the index of the alternative in clinch::Shape.
enum Kind : std::size_t { sphere = 0, box = 1, capsule = 2, cylinder = 3, cone = 4, plane = 5, hull = 6 };

/// A shape and what certificates need of it, in its body's frame.
struct Form {
    Shape shape;
    std::size_t kind = 0;
    std::array<double, 3> size{};  // radius | half extents | radius, half height
    double ball = 0;               // what is swept over the core: of a sphere or a capsule its radius
    double reach = 0;              // no point is farther from the origin
    std::vector<Vector<double>> points;
    std::vector<Real3> normals;  // of the faces of a box or hull, outward; of a plane its own; unit length
    std::vector<Real> heights;   // of those faces
    std::vector<Real3> edges;    // directions of the edges of a box, hull or capsule's core, each once
    Real3 middle;                // of a hull's points
    Real blur = 0;               // by how much, as angles, rounding may have turned the normals
};

/// Cost: of a hull of n points the fourth power of n.
Form form_of(const Shape& shape);

/// A body where it is, seen from the pair's first body.
template <class R>
struct Posed {
    const Form* form = nullptr;
    std::array<R, 9> turn{};  // row-major, body to world
    Vector<R> at;
    Vector<R> turned(const Vector<R>& v) const {
        return {turn[0] * v.x + turn[1] * v.y + turn[2] * v.z, turn[3] * v.x + turn[4] * v.y + turn[5] * v.z,
                turn[6] * v.x + turn[7] * v.y + turn[8] * v.z};
    }
    Vector<R> turned_back(const Vector<R>& v) const {
        return {turn[0] * v.x + turn[3] * v.y + turn[6] * v.z, turn[1] * v.x + turn[4] * v.y + turn[7] * v.z,
                turn[2] * v.x + turn[5] * v.y + turn[8] * v.z};
    }
    Vector<R> axis(std::size_t i) const { return {turn[i], turn[3 + i], turn[6 + i]}; }
};

/// Two bodies; a.at is 0.
struct PosedPair {
    Posed<Real> a, b;
    Real size = 0;  // reaches and the way between the positions together
};

/// A body as a scene has it.
struct CampaignBody {
    const Form* form = nullptr;
    Quat rotation;
    Vec3 position;
};

PosedPair posed(const CampaignBody& a, const CampaignBody& b);

/// The core's point that is farthest along n, from the body's position. Not of a plane.
template <class R>
Vector<R> farthest(const Posed<R>& body, const Vector<R>& n);

/// Lowest of b less highest of a along n (unit length): at most the true distance. Of a plane only along its normal.
Real parted_along(const PosedPair& pair, const Real3& n);

/// How far a point, seen from the pair's first body, is from the core of `body`, at most; 0 inside. Exact but for
/// hulls.
Real outside_core(const Posed<Real>& body, const Real3& point);

/// How far a point is outside a hull at least: beyond the plane of one of its faces.
Real beyond_faces(const Posed<Real>& hull, const Real3& point);

/// What is certain: low <= true distance <= high, up to 1e-17 of the pair's size.
struct Bracket {
    Real low = 0, high = 0;
    Real3 best;  // the direction that proves `low`
};

/// From the shapes alone: closed formulas, all axes of polytopes, else a search over directions that begins at `hints`
/// (unit vectors), which leaves `high` infinite. `thorough`: all axes also where there are many.
Bracket bracket_of(const PosedPair& pair, const std::vector<Real3>& hints, bool thorough, Random& random);

/// An upper bound of the distance: the way between two points, given from the first body's position, of which each
/// may be outside its body.
Real proved_by_points(const PosedPair& pair, const Real3& on_a, const Real3& on_b, const Real3& n);

}  // namespace clinch::test::campaign
