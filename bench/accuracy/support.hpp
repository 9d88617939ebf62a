// How far bodies reach, in long double: what references and the choice of poses are made from. Shares no code with the
// library's routines.
#pragma once

#include <array>
#include <vector>

#include "tests/narrow_phase/closed_form_cases.hpp"

namespace clinch::accuracy {

using Real = long double;
using Real3 = std::array<Real, 3>;

inline Real dot(const Real3& a, const Real3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Real3 cross(const Real3& a, const Real3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// a + s b
inline Real3 along(const Real3& a, Real s, const Real3& b) {
    return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]};
}
inline Real3 minus(const Real3& a, const Real3& b) {
    return along(a, -1, b);
}
Real length(const Real3& a);
/// a / |a|; a must not be 0.
Real3 unit(const Real3& a);

/// A body of any class but planes, around its position: a core and a ball that sweeps it.
class Reach {
public:
    explicit Reach(const test::TrueBody& body);
    /// The core's point farthest along n (of any length): from the body's position, in the world's axes.
    Real3 core_point(const Real3& n) const;
    /// How far the whole body reaches along the unit vector n.
    Real along(const Real3& n) const { return dot(n, core_point(n)) + ball_; }
    Real ball() const { return ball_; }
    /// Of the whole body, along its own axes, at most.
    Real size() const;
    /// The body's own axis in the world.
    Real3 axis(std::size_t i) const { return axes_[i]; }

private:
    test::Kind kind_;
    std::array<Real, 3> size_{};
    std::array<Real3, 3> axes_;  // each a body axis
    std::vector<Real3> points_;  // of a hull, in the body's frame
    Real ball_ = 0;
};

/// All points a - b of the cores of two bodies, b being at the position of a: a convex body M. The pair's signed
/// distance is that of `between`, b's position seen from a's, from M, less the two balls.
struct Difference {
    Reach a, b;
    Real3 between;

    explicit Difference(const test::TruePair& pair);
    /// M's point farthest along n.
    Real3 point(const Real3& n) const;
    Real balls() const { return a.ball() + b.ball(); }
    /// How far apart the bodies are along n, of any length: no more than the true distance, and for some n just that.
    Real apart(const Real3& n) const;
};

}  // namespace clinch::accuracy
