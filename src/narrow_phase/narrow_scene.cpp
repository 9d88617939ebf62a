#include "src/narrow_phase/narrow_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <variant>

#include "src/primitives/host_parallel.hpp"
#include "src/scene/convex_hull.hpp"
#include "src/scene/round_outward.hpp"
#include "src/scene/scene_impl.hpp"

namespace clinch::detail {
namespace {

constexpr std::size_t rows_worth_threads = 4096;
constexpr std::size_t vertex_block = 16;

// Row-major, body to world; each entry rounded once where a long double is longer than a double, else within 4 units of
// 2^-53.
void turn_of(const Quat& rotation, double* m) {
    const long double a = rotation.w, b = rotation.x, c = rotation.y, d = rotation.z;
    const long double s = 2.0L / (a * a + b * b + c * c + d * d);
    const long double turn[9] = {1.0L - s * (c * c + d * d), s * (b * c - a * d),        s * (b * d + a * c),
                                 s * (b * c + a * d),        1.0L - s * (b * b + d * d), s * (c * d - a * b),
                                 s * (b * d - a * c),        s * (c * d + a * b),        1.0L - s * (b * b + c * c)};
    for (std::size_t i = 0; i < 9; ++i) m[i] = static_cast<double>(turn[i]);
}

void round_frame(const BodyFrame64& from, BodyFrame32& to) {
    for (std::size_t d = 0; d < 3; ++d) {
        to.high[d] = static_cast<float>(from.position[d]);
        to.low[d] = static_cast<float>(from.position[d] - static_cast<double>(to.high[d]));
    }
    for (std::size_t i = 0; i < 9; ++i) to.turn[i] = static_cast<float>(from.turn[i]);
    to.shape = from.shape;
}
void round_frame(const BodyFrame64& from, BodyFrame64& to) {
    to = from;
}

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

BodyFrame64 frame_of(const Scene& scene, std::uint32_t row) {
    const Scene::Impl& s = scene.impl();
    BodyFrame64 frame{};
    frame.shape = s.shape[row];
    if (s.alive[row] == 0 || s.faults[row] != 0) return frame;
    frame.position[0] = s.position[row].x;
    frame.position[1] = s.position[row].y;
    frame.position[2] = s.position[row].z;
    turn_of(s.rotation[row], frame.turn);
    return frame;
}

template <class Frame>
void NarrowScene::send_frames(const Scene& scene, Frames<Frame>& frames) {
    const std::size_t rows_there = scene.row_count(), bytes = std::max<std::size_t>(rows_there, 1) * sizeof(Frame);
    const bool grown = frames.buffer.handle() == nullptr || frames.buffer.bytes() < bytes;
    if (grown)
        device_.reserve(frames.buffer, bytes + (frames.buffer.handle() == nullptr ? 0 : bytes / 2),
                        "the frames of bodies");
    const View<const std::uint32_t> rows = frames.tracker.changed(scene, grown);
    if (rows.empty()) return;
    frames.staging.resize(rows.size());
    parallel_rows(rows.size(), rows_worth_threads,
                  [&](std::size_t i) { round_frame(frame_of(scene, rows[i]), frames.staging[i]); });
    if (rows.size() == rows_there) {
        device_.write(frames.buffer, frames.staging.data(), rows.size() * sizeof(Frame));
    } else {
        if (!place_kernel_) place_kernel_ = device_.kernel("narrow_phase/buckets", "place_records");
        device_.reserve(rows_, rows.size() * sizeof(std::uint32_t), "the rows of bodies");
        device_.reserve(records_, rows.size() * sizeof(Frame), "the frames of changed bodies");
        device_.write(rows_, rows.data(), rows.size() * sizeof(std::uint32_t));
        device_.write(records_, frames.staging.data(), rows.size() * sizeof(Frame));
        constexpr auto words = static_cast<std::uint32_t>(sizeof(Frame) / sizeof(std::uint32_t));
        device_.launch_items(
            place_kernel_.args(records_, rows_, static_cast<std::uint32_t>(rows.size()), words, frames.buffer),
            rows.size());
    }
    frames.tracker.seen(scene);
}

template <class T>
void NarrowScene::send_shapes(const NarrowShapes& shapes, Shapes& to) {
    std::vector<NarrowShapeOf<T>> rounded(shapes.records().size());
    for (std::size_t i = 0; i < rounded.size(); ++i) {
        const NarrowShape64& from = shapes.records()[i];
        for (std::size_t d = 0; d < 3; ++d) {
            rounded[i].size[d] = static_cast<T>(from.size[d]);
            rounded[i].normal[d] = static_cast<T>(from.normal[d]);
        }
        rounded[i].kind = from.kind;
        rounded[i].first_vertex = from.first_vertex;
        rounded[i].vertex_count = from.vertex_count;
        rounded[i].stride = from.stride;
        rounded[i].first_face = from.first_face;
        rounded[i].face_count = from.face_count;
    }
    const std::vector<T> points(shapes.vertices().begin(), shapes.vertices().end());
    device_.reserve(to.records, rounded.size() * sizeof rounded[0], "shapes");
    device_.reserve(to.vertices, points.size() * sizeof(T), "the vertices of hulls");
    device_.write(to.records, rounded.data(), rounded.size() * sizeof rounded[0]);
    device_.write(to.vertices, points.data(), points.size() * sizeof(T));
    if (!shapes.faces().empty()) send_faces<T>(shapes, to);
    to.sent = true;
}

template <class T>
void NarrowScene::send_faces(const NarrowShapes& shapes, Shapes& to) {
    std::vector<NarrowFaceOf<T>> rounded;
    rounded.reserve(shapes.faces().size());
    for (const NarrowFace64& from : shapes.faces())
        rounded.push_back(
            {{static_cast<T>(from.normal[0]), static_cast<T>(from.normal[1]), static_cast<T>(from.normal[2])},
             static_cast<T>(from.thickness),
             from.first_corner,
             from.corners});
    device_.reserve(to.faces, rounded.size() * sizeof rounded[0], "the faces of hulls");
    device_.reserve(to.corners, shapes.corners().size() * sizeof(std::uint32_t), "the corners of faces");
    device_.write(to.faces, rounded.data(), rounded.size() * sizeof rounded[0]);
    device_.write(to.corners, shapes.corners().data(), shapes.corners().size() * sizeof(std::uint32_t));
}

void NarrowScene::update(const Scene& scene, const NarrowShapes& shapes, unsigned bits) {
    if (bits == 64) {
        if (!shapes64_.sent) send_shapes<double>(shapes, shapes64_);
        send_frames(scene, frames64_);
    } else {
        if (!shapes32_.sent) send_shapes<float>(shapes, shapes32_);
        send_frames(scene, frames32_);
    }
}

void NarrowScene::update_classes(const Scene& scene, const NarrowShapes& shapes) {
    const Scene::Impl& s = scene.impl();
    const std::size_t rows_there = scene.row_count();
    const View<const std::uint32_t> rows = class_tracker_.changed(scene, host_classes_.size() != rows_there);
    if (rows.empty()) return;
    host_classes_.resize(rows_there);
    for (const std::uint32_t row : rows)
        host_classes_[row] = s.alive[row] == 0 || s.faults[row] != 0
                                 ? no_class
                                 : static_cast<std::uint8_t>(shapes.records()[s.shape[row]].kind);
    device_.reserve(classes_, rows_there, "the classes of bodies");
    device_.write(classes_, host_classes_.data(), rows_there);
    std::vector<float> margins(rows_there);
    has_margins_ = false;
    for (std::size_t row = 0; row < rows_there; ++row) {
        margins[row] = host_classes_[row] == no_class ? 0.0f : length_up(s.margin[row]);
        has_margins_ = has_margins_ || margins[row] > 0.0f;
    }
    if (has_margins_) {
        device_.reserve(margins_, rows_there * sizeof(float), "the margins of bodies");
        device_.write(margins_, margins.data(), rows_there * sizeof(float));
    }
    class_tracker_.seen(scene);
}

void NarrowScene::forget() {
    frames32_.tracker.forget();
    frames64_.tracker.forget();
    class_tracker_.forget();
    shapes_changed();
}

}  // namespace clinch::detail
