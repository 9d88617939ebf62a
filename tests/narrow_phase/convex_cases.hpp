// Pairs of convex bodies for tests of the general routine, random and hostile, and what their true distance must be
// near.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/narrow_phase/polytope_oracle.hpp"
#include "tests/random.hpp"

namespace clinch::test {

/// A body by its class number (as the index in clinch::Shape): sphere 0, box 1, capsule 2, cylinder 3, cone 4, hull 6.
struct ConvexBody {
    std::uint32_t kind = 0;
    std::array<double, 3> size{};
    std::vector<Vec3> points;  // of a hull
    Quat rotation;
    Vec3 position;
};

struct ConvexBodies {
    ConvexBody a, b;
};

/// How a pair lies.
enum class Regime { any, flat, unequal, parallel, nearly_parallel, concentric, nearly_concentric, far_scale };

/// In double, whatever the precision of the routine: the numbers that a contact would have.
struct ConvexAnswer {
    double distance = 0, error = 0;
    std::array<double, 3> normal{}, point{};
};

ConvexBodies random_bodies(std::uint32_t kind_a, std::uint32_t kind_b, Regime regime, Random& random);

/// Moves b along the unit vector `normal`.
void move(ConvexBody& b, const std::array<double, 3>& normal, double by);

/// Reaches of both bodies and the way between them, together.
double size_of(const ConvexBodies& pair);

/// Spheres, boxes, capsules and hulls as what polytope_oracle.hpp knows.
Polytope polytope_of(const ConvexBody& body);

/// Lowest of b less highest of a along n (of any length, taken as unit): no more than the true distance, and for some n
/// just that.
long double separation(const ConvexBodies& pair, const std::array<long double, 3>& n);

/// The greatest separation found from `start` and among random directions, by climbing: a lower bound on the true
/// distance, near it.
long double best_separation(const ConvexBodies& pair, const std::array<double, 3>& start, Random& random);

/// How far outside the body a point of the world is, at most (0 inside); not of hulls.
long double outside(const ConvexBody& body, const std::array<long double, 3>& p);

/// Whether a cylinder or a cone is among them.
bool is_curved(const ConvexBodies& pair);

/// What `answer` breaks of the promises in touch.clh, empty if none. `unit`: half an ulp of 1; tolerance: how much less
/// than the distance the normal may be worth, of the size; careful: as in polytope_oracle.hpp.
std::string broken_promise(const ConvexBodies& pair, const ConvexAnswer& answer, double unit, double tolerance,
                           bool careful, Random& random);

/// How far the answer's points are off their bodies; of hulls not looked at.
long double witness_error(const ConvexBodies& pair, const ConvexAnswer& answer);

std::string text_of(const ConvexBodies& pair);

}  // namespace clinch::test
