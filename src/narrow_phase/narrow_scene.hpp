// Bodies and shapes of a scene as narrow-phase routines read them, kept on a device from call to call.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "clinch/scene.hpp"
#include "src/device/device.hpp"
#include "src/scene/bounds.hpp"

namespace clinch::detail {

// As the structs of cl/narrow_phase/body.clh.
struct BodyFrame32 {
    float high[3], low[3], turn[9];
    std::uint32_t shape;
};
struct BodyFrame64 {
    double position[3], turn[9];
    std::uint32_t shape, unused;
};
template <class T>
struct NarrowShapeOf {
    T size[3], normal[3];
    std::uint32_t kind, first_vertex, vertex_count, stride, first_face, face_count;
};
// As the struct of cl/narrow_phase/patch.clh.
template <class T>
struct NarrowFaceOf {
    T normal[3], thickness;
    std::uint32_t first_corner, corners;
};
using NarrowShape32 = NarrowShapeOf<float>;
using NarrowShape64 = NarrowShapeOf<double>;
static_assert(sizeof(BodyFrame32) == 64 && sizeof(BodyFrame64) == 104, "kernels read this layout");
using NarrowFace64 = NarrowFaceOf<double>;
static_assert(sizeof(NarrowShape32) == 48 && sizeof(NarrowShape64) == 72, "kernels read this layout");
static_assert(sizeof(NarrowFaceOf<float>) == 24 && sizeof(NarrowFace64) == 40, "kernels read this layout");

/// A body that takes no part: class of a row that is not there or is rejected.
constexpr std::uint8_t no_class = 255;

/// The shapes of a scene: one record each, and the vertices of hulls as columns x, y, z, each `stride` (a multiple of
/// 16) long from first_vertex on, with the last vertex repeated; with faces, those of hulls, too. In float64, and
/// rounded once to float32.
class NarrowShapes {
public:
    /// Without faces, hulls have none.
    explicit NarrowShapes(bool with_faces) : with_faces_(with_faces) {}
    /// Brings the records up to date; true if anything changed. Cost: the changed hulls.
    bool update(const Scene& scene);
    const std::vector<NarrowShape64>& records() const noexcept { return records_; }
    const std::vector<double>& vertices() const noexcept { return vertices_; }
    const std::vector<NarrowFace64>& faces() const noexcept { return faces_; }
    /// Of faces: numbers of the hull's vertices.
    const std::vector<std::uint32_t>& corners() const noexcept { return corners_; }

private:
    void add(const Shape& shape);
    void add_faces(NarrowShape64& record, const std::vector<Vec3>& points);
    bool with_faces_;
    std::shared_ptr<const int> identity_;
    std::uint64_t version_ = 0;
    std::vector<NarrowShape64> records_;
    std::vector<double> vertices_;
    std::vector<NarrowFace64> faces_;
    std::vector<std::uint32_t> corners_;
};

/// The frame of a row that is in use, in float64: what all others are rounded from.
BodyFrame64 frame_of(const Scene& scene, std::uint32_t row);

/// All of it on a device: what a call asks for and what changed since is sent.
class NarrowScene {
public:
    explicit NarrowScene(Device& device) : device_(device) {}

    /// Brings the float32 (`bits` 32) or float64 (64) frames and shapes on the device up to date with the scene.
    void update(const Scene& scene, const NarrowShapes& shapes, unsigned bits);
    /// Shapes are sent anew when they are next needed.
    void shapes_changed() noexcept { shapes32_.sent = shapes64_.sent = false; }
    /// Brings classes and margins up to date; the latter only if any row has one.
    void update_classes(const Scene& scene, const NarrowShapes& shapes);
    const Buffer& bodies(unsigned bits) const { return bits == 64 ? frames64_.buffer : frames32_.buffer; }
    const Buffer& shapes(unsigned bits) const { return shapes_of(bits).records; }
    const Buffer& vertices(unsigned bits) const { return shapes_of(bits).vertices; }
    /// Of hulls; empty without.
    const Buffer& faces(unsigned bits) const { return shapes_of(bits).faces; }
    const Buffer& corners(unsigned bits) const { return shapes_of(bits).corners; }
    const Buffer& classes() const { return classes_; }
    /// One float a row, rounded up; only if has_margins().
    const Buffer& margins() const { return margins_; }
    bool has_margins() const noexcept { return has_margins_; }
    /// Everything is sent anew the next time.
    void forget();

private:
    template <class Frame>
    struct Frames {
        RowTracker tracker;
        Buffer buffer;
        std::vector<Frame> staging;
    };
    struct Shapes {
        Buffer records, vertices, faces, corners;
        bool sent = false;
    };
    const Shapes& shapes_of(unsigned bits) const noexcept { return bits == 64 ? shapes64_ : shapes32_; }
    template <class Frame>
    void send_frames(const Scene& scene, Frames<Frame>& frames);
    template <class T>
    void send_shapes(const NarrowShapes& shapes, Shapes& to);
    template <class T>
    void send_faces(const NarrowShapes& shapes, Shapes& to);

    Device& device_;
    Kernel place_kernel_;
    Frames<BodyFrame32> frames32_;
    Frames<BodyFrame64> frames64_;
    Shapes shapes32_, shapes64_;
    Buffer rows_, records_, classes_, margins_;
    RowTracker class_tracker_;
    std::vector<std::uint8_t> host_classes_;
    bool has_margins_ = false;
};

}  // namespace clinch::detail
