// The shapes of a scene, with what the bounds stage needs of them in one array each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "clinch/shape.hpp"
#include "src/scene/shape_bounds.hpp"

namespace clinch::detail {

/// No row: the end of a list of rows.
constexpr std::uint32_t no_row = 0xffffffffu;

/// One shape; its ShapeRecord stands in ShapeStore::records().
struct StoredShape {
    Shape shape;
    std::string why;     ///< as why_invalid()
    double reach = 0.0;  ///< as ShapeBounds::reach
    bool is_plane = false;
    std::uint64_t version = 0;         ///< scene version of the last change of its record or vertices
    std::uint32_t first_row = no_row;  ///< start of the list of rows that bear it: see SceneRows
};

/// Shapes in the order of their ids. Vertices of hulls and meshes lie in one array; a replaced shape takes its
/// old place there if it fits, and the array is packed anew when half of it is unused.
class ShapeStore {
public:
    std::size_t size() const noexcept { return shapes_.size(); }
    StoredShape& operator[](std::size_t i) noexcept { return shapes_[i]; }
    const StoredShape& operator[](std::size_t i) const noexcept { return shapes_[i]; }

    /// Adds a shape as of scene version `version`.
    void add(Shape shape, std::uint64_t version);
    void replace(std::size_t i, Shape shape, std::uint64_t version);

    /// One record a shape; those of invalid shapes and planes name no vertices and are not used.
    const std::vector<ShapeRecord>& records() const noexcept { return records_; }
    /// x y z of all vertices.
    const std::vector<float>& vertices() const noexcept { return vertices_; }
    /// Scene version of the last change of any record or vertex.
    std::uint64_t version() const noexcept { return version_; }

private:
    void put_vertices(ShapeRecord& record, const std::vector<float>& vertices, std::uint32_t first,
                      std::uint32_t capacity);
    void pack(std::uint64_t version);

    std::vector<StoredShape> shapes_;
    std::vector<ShapeRecord> records_;
    std::vector<std::uint32_t> capacity_;  // vertices a shape's place in vertices_ holds
    std::vector<float> vertices_;
    std::size_t used_ = 0;  // vertices in use
    std::uint64_t version_ = 0;
};

}  // namespace clinch::detail
