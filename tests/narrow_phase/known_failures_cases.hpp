// Cases of pairs that narrow phases are known to get wrong, and how every answer to them is checked.
#pragma once

#include <string>
#include <vector>

#include "clinch/scene.hpp"

namespace clinch::test::known {

constexpr double pi = 3.14159265358979323846;

struct Case {
    std::string what;
    Shape a;
    Pose at_a;
    Shape b;
    Pose at_b;
    double distance = 0;          // the true one
    std::vector<Vec3> normals{};  // one of which it is; empty: none is told
    double error = 1e-13;         // of the pair's size, that float64 may promise at most
    double error32 = 1e-4;        // the same for float32
};

/// A turn by `angle` about an axis of any length.
Quat about(const Vec3& axis, double angle);

/// The case with both bodies turned, then moved.
Case moved(Case c, const Quat& turn, const Vec3& by);

Box cube(double half);
/// The corners of a box.
Hull as_hull(const Box& box);
/// Adds a case of boxes, then with one and with both as hulls.
void add_with_hulls(std::vector<Case>& cases, Case c);

/// None, about an axis, askew.
const std::vector<Quat>& some_turns();

/// Asks for each pair once on the host, in float64, and 200 times on a device at precisions 0, 0.5 and 1. Each time the
/// distance is the true one within the error, the error small, the normal one of those named, and no answer is lost.
void check(const std::vector<Case>& cases);

}  // namespace clinch::test::known
