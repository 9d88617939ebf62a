#include <cmath>
#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "clinch/shape.hpp"
#include "src/scene/convex_hull.hpp"
#include "src/scene/text.hpp"

namespace clinch {
namespace {

using detail::text;

std::string above_zero(const char* what, double x) {
    if (std::isfinite(x) && x > 0.0) return {};
    return text(what, x, "finite and > 0");
}

std::string first_of(std::string a, std::string b) {
    return a.empty() ? std::move(b) : std::move(a);
}

std::string all_finite(const char* what, const std::vector<Vec3>& points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (const double x : {points[i].x, points[i].y, points[i].z}) {
            if (!std::isfinite(x))
                return std::string(what) + " " + std::to_string(i) + " has a coordinate that is " + text(x) +
                       " and must be finite";
        }
    }
    return {};
}

struct Why {
    std::string operator()(const Sphere& s) const { return above_zero("radius", s.radius); }
    std::string operator()(const Box& s) const {
        return first_of(
            above_zero("half extent x", s.half_extents.x),
            first_of(above_zero("half extent y", s.half_extents.y), above_zero("half extent z", s.half_extents.z)));
    }
    std::string operator()(const Capsule& s) const {
        std::string why = above_zero("radius", s.radius);
        if (why.empty() && !(std::isfinite(s.half_height) && s.half_height >= 0.0))
            why = text("half height", s.half_height, "finite and >= 0");
        return why;
    }
    std::string operator()(const Cylinder& s) const {
        return first_of(above_zero("radius", s.radius), above_zero("half height", s.half_height));
    }
    std::string operator()(const Cone& s) const {
        return first_of(above_zero("radius", s.radius), above_zero("half height", s.half_height));
    }
    std::string operator()(const Plane& s) const {
        const double length = std::hypot(s.normal.x, s.normal.y, s.normal.z);
        if (!(std::fabs(length - 1.0) <= 1e-3))
            return "plane normal has length " + text(length) + " and must be within 1e-3 of 1";
        if (!std::isfinite(s.offset)) return text("plane offset", s.offset, "finite");
        return {};
    }
    std::string operator()(const Hull& s) const {
        std::string why = all_finite("hull point", s.points);
        if (!why.empty()) return why;
        if (s.points.size() < 4)
            return "hull has " + std::to_string(s.points.size()) + " points and must have at least 4";
        if (!detail::spans_volume(s.points)) return "hull has no volume: its points lie in one plane";
        return {};
    }
    std::string operator()(const Mesh& s) const {
        if (s.triangles.empty()) return "mesh has no triangles and must have at least 1";
        for (std::size_t t = 0; t < s.triangles.size(); ++t) {
            for (const std::uint32_t v : s.triangles[t]) {
                if (v >= s.vertices.size())
                    return "mesh triangle " + std::to_string(t) + " names vertex " + std::to_string(v) +
                           " and must name one below " + std::to_string(s.vertices.size());
            }
        }
        return all_finite("mesh vertex", s.vertices);
    }
};

}  // namespace

std::string why_invalid(const Shape& shape) {
    if (shape.valueless_by_exception()) return "shape is empty and must be one of the shape classes";
    return std::visit(Why{}, shape);
}

}  // namespace clinch
