#include "bench/accuracy/support.hpp"

#include <algorithm>
#include <cmath>

namespace clinch::accuracy {
namespace {

std::array<Real3, 3> axes_of(const std::array<double, 4>& rotation) {
    const Real w = rotation[0], x = rotation[1], y = rotation[2], z = rotation[3];
    const Real s = 2 / (w * w + x * x + y * y + z * z);
    return {{{1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)},
             {s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)},
             {s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)}}};
}

Real with_sign(Real length, Real sign) {
    return sign < 0 ? -length : length;
}

// The point of the disc of radius r at height z that is farthest along (m0, m1).
Real3 on_disc(Real r, Real z, const Real3& m) {
    const Real across = std::hypot(m[0], m[1]);
    return across > 0 ? Real3{r * m[0] / across, r * m[1] / across, z} : Real3{r, 0, z};
}

}  // namespace

Real length(const Real3& a) {
    return std::sqrt(dot(a, a));
}

Real3 unit(const Real3& a) {
    const Real l = length(a);
    return {a[0] / l, a[1] / l, a[2] / l};
}

Reach::Reach(const test::TrueBody& body) : kind_(body.kind), axes_(axes_of(body.rotation)) {
    for (std::size_t d = 0; d < 3; ++d) size_[d] = body.size[d];
    for (const auto& p : body.points) points_.push_back({p[0], p[1], p[2]});
    if (kind_ == test::Kind::sphere || kind_ == test::Kind::capsule) ball_ = size_[0];
}

Real3 Reach::core_point(const Real3& n) const {
    const Real3 m{dot(axes_[0], n), dot(axes_[1], n), dot(axes_[2], n)};
    Real3 p{};
    switch (kind_) {
        case test::Kind::box:
            p = {with_sign(size_[0], m[0]), with_sign(size_[1], m[1]), with_sign(size_[2], m[2])};
            break;
        case test::Kind::capsule:
            p[2] = with_sign(size_[1], m[2]);
            break;
        case test::Kind::cylinder:
            p = on_disc(size_[0], with_sign(size_[1], m[2]), m);
            break;
        case test::Kind::cone:
            // The apex, or the rim.
            p = 2 * size_[1] * m[2] > size_[0] * std::hypot(m[0], m[1]) ? Real3{0, 0, size_[1]}
                                                                        : on_disc(size_[0], -size_[1], m);
            break;
        case test::Kind::hull: {
            Real most = -INFINITY;
            for (const Real3& q : points_) {
                const Real d = dot(m, q);
                if (d > most) {
                    most = d;
                    p = q;
                }
            }
            break;
        }
        default:
            break;
    }
    Real3 world{};
    for (std::size_t i = 0; i < 3; ++i) world = accuracy::along(world, p[i], axes_[i]);
    return world;
}

Real Reach::size() const {
    Real most = 0;
    for (const Real3& n : axes_) most = std::max({most, along(n), along({-n[0], -n[1], -n[2]})});
    return most;
}

Difference::Difference(const test::TruePair& pair) : a(pair.a), b(pair.b), between{} {
    for (std::size_t d = 0; d < 3; ++d) between[d] = Real(pair.b.position[d]) - Real(pair.a.position[d]);
}

Real3 Difference::point(const Real3& n) const {
    return minus(a.core_point(n), b.core_point({-n[0], -n[1], -n[2]}));
}

Real Difference::apart(const Real3& n) const {
    const Real3 u = unit(n);
    return dot(u, minus(between, point(u))) - balls();
}

}  // namespace clinch::accuracy
