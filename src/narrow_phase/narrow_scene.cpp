#include "src/narrow_phase/narrow_scene.hpp"

#include <algorithm>

namespace clinch::detail {

// All of them, unless few have changed.
template <class Frame>
void NarrowScene::send_frames(const Scene& scene, View<const Frame> all, Frames<Frame>& frames) {
    const std::size_t bytes = std::max<std::size_t>(all.size(), 1) * sizeof(Frame);
    const bool grown = frames.buffer.handle() == nullptr || frames.buffer.bytes() < bytes;
    if (grown)
        device_.reserve(frames.buffer, bytes + (frames.buffer.handle() == nullptr ? 0 : bytes / 2),
                        "the frames of bodies");
    const View<const std::uint32_t> rows = frames.tracker.changed(scene, grown);
    if (rows.empty()) return;
    if (2 * rows.size() >= all.size()) {
        device_.write(frames.buffer, all.data(), all.size() * sizeof(Frame));
    } else {
        frames.staging.resize(rows.size());
        for (std::size_t i = 0; i < rows.size(); ++i) frames.staging[i] = all[rows[i]];
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
        send_frames(scene, host_.frames64(scene), frames64_);
    } else {
        if (!shapes32_.sent) send_shapes<float>(shapes, shapes32_);
        send_frames(scene, host_.frames32(scene), frames32_);
    }
}

void NarrowScene::update_classes(const Scene& scene, const NarrowShapes& shapes) {
    const HostBodies::Classes now = host_.classes(scene, shapes);
    host_classes_ = now.classes;
    if (now.version == classes_version_ || now.classes.empty()) return;
    classes_version_ = 0;  // until all went well
    device_.reserve(classes_, now.classes.size(), "the classes of bodies");
    device_.write(classes_, now.classes.data(), now.classes.size());
    has_margins_ = !now.margins.empty();
    if (has_margins_) {
        device_.reserve(margins_, now.margins.size() * sizeof(float), "the margins of bodies");
        device_.write(margins_, now.margins.data(), now.margins.size() * sizeof(float));
    }
    classes_version_ = now.version;
}

void NarrowScene::forget() {
    frames32_.tracker.forget();
    frames64_.tracker.forget();
    classes_version_ = 0;
    shapes_changed();
}

}  // namespace clinch::detail
