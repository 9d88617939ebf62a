#include "src/narrow_phase/narrow_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include "src/scene/convex_hull.hpp"
#include "src/scene/scene_impl.hpp"

namespace clinch::detail {
namespace {

constexpr std::size_t vertex_block = 16;

struct FillShape {
    NarrowShape64& record;
    std::vector<double>& vertices;
    std::vector<Vec3>& points;  // of a hull: its outermost

    void set(double a, double b = 0.0, double c = 0.0) const {
        record.size[0] = a;
        record.size[1] = b;
        record.size[2] = c;
    }
    void operator()(const Sphere& s) const { set(s.radius); }
    void operator()(const Box& s) const { set(s.half_extents.x, s.half_extents.y, s.half_extents.z); }
    void operator()(const Capsule& s) const { set(s.radius, s.half_height); }
    void operator()(const Cylinder& s) const { set(s.radius, s.half_height); }
    void operator()(const Cone& s) const { set(s.radius, s.half_height); }
    void operator()(const Plane& s) const {
        const double length = std::sqrt(s.normal.x * s.normal.x + s.normal.y * s.normal.y + s.normal.z * s.normal.z);
        set(s.offset / length);
        record.normal[0] = s.normal.x / length;
        record.normal[1] = s.normal.y / length;
        record.normal[2] = s.normal.z / length;
    }
    void operator()(const Hull& s) const {
        points = outermost_points(s.points);
        record.first_vertex = static_cast<std::uint32_t>(vertices.size());
        record.vertex_count = static_cast<std::uint32_t>(points.size());
        record.stride = static_cast<std::uint32_t>((points.size() + vertex_block - 1) / vertex_block * vertex_block);
        for (const auto coordinate : {&Vec3::x, &Vec3::y, &Vec3::z})
            for (std::size_t i = 0; i < record.stride; ++i)
                vertices.push_back(points[std::min(i, points.size() - 1)].*coordinate);
    }
    void operator()(const Mesh&) const {}
};

}  // namespace

void NarrowShapes::add(const Shape& shape) {
    NarrowShape64 record{};
    record.kind = static_cast<std::uint32_t>(shape.index());
    std::vector<Vec3> points;
    if (why_invalid(shape).empty()) std::visit(FillShape{record, vertices_, points}, shape);
    if (with_faces_ && !points.empty()) add_faces(record, points);
    records_.push_back(record);
}

void NarrowShapes::add_faces(NarrowShape64& record, const std::vector<Vec3>& points) {
    record.first_face = static_cast<std::uint32_t>(faces_.size());
    for (const HullFace& face : hull_faces(points)) {
        faces_.push_back({{face.normal.x, face.normal.y, face.normal.z},
                          face.thickness,
                          static_cast<std::uint32_t>(corners_.size()),
                          static_cast<std::uint32_t>(face.corners.size())});
        corners_.insert(corners_.end(), face.corners.begin(), face.corners.end());
    }
    record.face_count = static_cast<std::uint32_t>(faces_.size()) - record.first_face;
}

bool NarrowShapes::update(const Scene& scene) {
    const ShapeStore& store = scene.impl().shapes;
    if (identity_ == scene.impl().identity && version_ == store.version() && records_.size() == store.size())
        return false;
    records_.clear();
    vertices_.clear();
    faces_.clear();
    corners_.clear();
    for (std::size_t i = 0; i < store.size(); ++i) add(store[i].shape);
    identity_ = scene.impl().identity;
    version_ = store.version();
    return true;
}

}  // namespace clinch::detail
