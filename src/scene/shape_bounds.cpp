#include "src/scene/shape_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include "src/scene/convex_hull.hpp"
#include "src/scene/round_outward.hpp"

namespace clinch::detail {
namespace {

// Below this looking at every point costs less than finding out which ones matter.
constexpr std::size_t few_points = 32;

std::vector<Vec3> used_vertices(const Mesh& mesh) {
    std::vector<char> used(mesh.vertices.size(), 0);
    for (const auto& triangle : mesh.triangles)
        for (const std::uint32_t v : triangle) used[v] = 1;
    std::vector<Vec3> out;
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (used[i]) out.push_back(mesh.vertices[i]);
    }
    return out;
}

// Rounds coordinates to float32 and keeps the largest error.
class VertexRounding {
public:
    float operator()(double x) {
        auto f = static_cast<float>(x);
        if (std::fabs(f) < smallest_length) f = 0.0f;
        error_ = std::max(error_, std::fabs(x - static_cast<double>(f)));
        return f;
    }
    float error() const { return length_up(error_); }

private:
    double error_ = 0.0;
};

void set_vertices(ShapeBounds& out, std::vector<Vec3> points) {
    if (points.size() > few_points) points = outermost_points(std::move(points));
    VertexRounding rounded;
    out.vertices.reserve(3 * points.size());
    for (const Vec3& p : points) {
        out.reach = std::max(out.reach, std::fabs(p.x) + std::fabs(p.y) + std::fabs(p.z));
        // Larger numbers are no float32; bodies of such a shape are rejected for their reach.
        if (out.reach > 1e38) continue;
        for (const double c : {p.x, p.y, p.z}) out.vertices.push_back(rounded(c));
    }
    out.record.vertex_count = static_cast<uint>(out.vertices.size() / 3);
    out.record.vertex_error = rounded.error();
}

void set_sizes(ShapeBounds& out, double a, double b = 0.0, double c = 0.0) {
    out.reach = a + b + c;
    if (out.reach > 1e38) return;
    out.record.size[0] = length_up(a);
    out.record.size[1] = length_up(b);
    out.record.size[2] = length_up(c);
}

struct Fill {
    ShapeBounds& out;
    void operator()(const Sphere& s) const { set_sizes(out, s.radius); }
    void operator()(const Box& s) const { set_sizes(out, s.half_extents.x, s.half_extents.y, s.half_extents.z); }
    void operator()(const Capsule& s) const { set_sizes(out, s.radius, s.half_height); }
    void operator()(const Cylinder& s) const { set_sizes(out, s.radius, s.half_height); }
    void operator()(const Cone& s) const { set_sizes(out, s.radius, s.half_height); }
    void operator()(const Plane&) const {}
    void operator()(const Hull& s) const { set_vertices(out, s.points); }
    void operator()(const Mesh& s) const { set_vertices(out, used_vertices(s)); }
};

}  // namespace

ShapeBounds shape_bounds(const Shape& shape) {
    ShapeBounds out;
    out.is_plane = std::holds_alternative<Plane>(shape);
    out.why = why_invalid(shape);
    if (!out.why.empty()) return out;
    out.record.kind = static_cast<uint>(shape.index());
    std::visit(Fill{out}, shape);
    // The sum in float64 may be off by two roundings, and sizes were rounded up to at least
    // smallest_length; both are far inside the slack that `scale` stands for.
    if (out.reach <= 1e38) out.record.scale = length_up(out.reach);
    return out;
}

}  // namespace clinch::detail
