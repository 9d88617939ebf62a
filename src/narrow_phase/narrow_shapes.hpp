// Shapes of a scene as narrow-phase routines read them, on the host.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "clinch/scene.hpp"

namespace clinch::detail {

// As the structs of cl/narrow_phase/body.clh.
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
using NarrowFace64 = NarrowFaceOf<double>;
static_assert(sizeof(NarrowShape32) == 48 && sizeof(NarrowShape64) == 72, "kernels read this layout");
static_assert(sizeof(NarrowFaceOf<float>) == 24 && sizeof(NarrowFace64) == 40, "kernels read this layout");

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

}  // namespace clinch::detail
