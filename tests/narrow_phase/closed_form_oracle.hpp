// The true distance of two simple bodies, to some 30 digits, by other ways than the routines go: polytopes by all their
// features, bodies of revolution by their outline in the half plane of the point.
#pragma once

#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <vector>

namespace clinch::test {

using Exact = boost::multiprecision::number<boost::multiprecision::cpp_bin_float_quad::backend_type,
                                            boost::multiprecision::et_off>;
using Exact3 = std::array<Exact, 3>;

enum class Kind { sphere, box, capsule, cylinder, cone, plane, hull };

/// A body as the scene is given it.
struct TrueBody {
    Kind kind = Kind::sphere;
    std::array<double, 3> size{};                // as Side::size
    std::array<double, 3> normal{0, 0, 1};       // of a plane; of any length
    std::vector<std::array<double, 3>> points;   // of a hull
    std::array<double, 4> rotation{1, 0, 0, 0};  // w x y z; of any length
    std::array<double, 3> position{};
};

/// The columns are the body's axes in the world.
std::array<Exact3, 3> axes(const TrueBody& body);
/// normal / |normal|, offset / |normal|.
std::array<Exact, 4> unit_plane(const TrueBody& plane);

/// As touch.clh defines it. One of the two is a sphere or a plane, or both are boxes, or both capsules.
Exact true_distance(const TrueBody& a, const TrueBody& b);
/// The signed distance of a point, given from the position of `body`, from its surface.
Exact from_surface(const TrueBody& body, const Exact3& point);
/// How far apart a and b are along n (of any length): the greatest over all n is the true distance.
Exact parted_along(const TrueBody& a, const TrueBody& b, const Exact3& n);

}  // namespace clinch::test
