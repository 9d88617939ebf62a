// How far a point is from the surface of a shape, by plain formulas that share nothing with the routines.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "clinch/pose.hpp"
#include "clinch/shape.hpp"

namespace clinch::test {

inline Vec3 rotated(const Quat& q, const Vec3& v) {
    const double s = 2.0 / (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    const Vec3 t{s * (q.y * v.z - q.z * v.y), s * (q.z * v.x - q.x * v.z), s * (q.x * v.y - q.y * v.x)};
    return {v.x + q.w * t.x + q.y * t.z - q.z * t.y, v.y + q.w * t.y + q.z * t.x - q.x * t.z,
            v.z + q.w * t.z + q.x * t.y - q.y * t.x};
}

/// Over the surfaces that bound the shape, the farthest the point is outside of one.
struct Surface {
    Vec3 p;  ///< in the body's frame

    double operator()(const Sphere& s) const { return length(p) - s.radius; }
    double operator()(const Box& s) const {
        return std::max(
            {std::fabs(p.x) - s.half_extents.x, std::fabs(p.y) - s.half_extents.y, std::fabs(p.z) - s.half_extents.z});
    }
    double operator()(const Capsule& s) const {
        return length({p.x, p.y, p.z - std::clamp(p.z, -s.half_height, s.half_height)}) - s.radius;
    }
    double operator()(const Cylinder& s) const { return std::max(out() - s.radius, std::fabs(p.z) - s.half_height); }
    double operator()(const Cone& s) const {
        const double slant = std::hypot(2.0 * s.half_height, s.radius);
        const double side = (out() * 2.0 * s.half_height + (p.z - s.half_height) * s.radius) / slant;
        return std::max(side, -s.half_height - p.z);
    }
    double operator()(const Plane& s) const {
        return (s.normal.x * p.x + s.normal.y * p.y + s.normal.z * p.z - s.offset) / length(s.normal);
    }
    // Over the planes through any three points that have all others on one side.
    double operator()(const Hull& s) const {
        double most = -std::numeric_limits<double>::infinity();
        const std::size_t n = s.points.size();
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = i + 1; j < n; ++j)
                for (std::size_t k = j + 1; k < n; ++k) most = std::max(most, beyond(s.points, i, j, k));
        return most;
    }
    double operator()(const Mesh&) const { return std::numeric_limits<double>::quiet_NaN(); }

private:
    static double length(const Vec3& v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }
    double out() const { return std::hypot(p.x, p.y); }
    double beyond(const std::vector<Vec3>& points, std::size_t i, std::size_t j, std::size_t k) const {
        const Vec3 &a = points[i], &b = points[j], &c = points[k];
        const Vec3 u{b.x - a.x, b.y - a.y, b.z - a.z}, v{c.x - a.x, c.y - a.y, c.z - a.z};
        Vec3 normal{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
        const double size = length(normal);
        if (size < 1e-12) return -std::numeric_limits<double>::infinity();
        normal = {normal.x / size, normal.y / size, normal.z / size};
        const auto height = [&](const Vec3& x) {
            return normal.x * (x.x - a.x) + normal.y * (x.y - a.y) + normal.z * (x.z - a.z);
        };
        double low = 0.0, high = 0.0;
        for (const Vec3& x : points) {
            low = std::min(low, height(x));
            high = std::max(high, height(x));
        }
        if (high < 1e-12) return height(p);
        return low > -1e-12 ? -height(p) : -std::numeric_limits<double>::infinity();
    }
};

/// Above 0 outside (near edges and corners a little less than the distance), below inside.
inline double surface_distance(const Shape& shape, const Pose& pose, const Vec3& point) {
    const Quat& q = pose.rotation;
    const Vec3 away{point.x - pose.position.x, point.y - pose.position.y, point.z - pose.position.z};
    return std::visit(Surface{rotated({q.w, -q.x, -q.y, -q.z}, away)}, shape);
}

}  // namespace clinch::test
