#include "src/scene/shape_store.hpp"

#include <algorithm>
#include <utility>

#include "clinch/error.hpp"

namespace clinch::detail {

void ShapeStore::add(Shape shape, std::uint64_t version) {
    if (shapes_.size() >= no_row)
        throw Error(ErrorCode::LimitExceeded, "the scene has 4294967295 shapes and can hold no more");
    ShapeBounds bounds = shape_bounds(shape);
    StoredShape stored;
    stored.shape = std::move(shape);
    stored.why = std::move(bounds.why);
    stored.reach = bounds.reach;
    stored.is_plane = bounds.is_plane;
    stored.version = version;
    if (shapes_.size() == shapes_.capacity()) shapes_.reserve(shapes_.size() + 1 + shapes_.size() / 2);
    capacity_.reserve(shapes_.capacity());
    records_.reserve(shapes_.capacity());
    put_vertices(bounds.record, bounds.vertices, 0, 0);
    capacity_.push_back(bounds.record.vertex_count);
    records_.push_back(bounds.record);
    shapes_.push_back(std::move(stored));
    version_ = version;
}

void ShapeStore::replace(std::size_t i, Shape shape, std::uint64_t version) {
    ShapeBounds bounds = shape_bounds(shape);
    put_vertices(bounds.record, bounds.vertices, records_[i].first_vertex, capacity_[i]);
    used_ -= records_[i].vertex_count;
    capacity_[i] = std::max(capacity_[i], bounds.record.vertex_count);
    records_[i] = bounds.record;
    StoredShape& stored = shapes_[i];
    stored.shape = std::move(shape);
    stored.why = std::move(bounds.why);
    stored.reach = bounds.reach;
    stored.is_plane = bounds.is_plane;
    stored.version = version;
    version_ = version;
    if (vertices_.size() / 3 > 2 * used_ + 1024) pack(version);
}

// Writes the vertices at `first` if `capacity` holds them, else at the end, and notes where in `record`.
void ShapeStore::put_vertices(ShapeRecord& record, const std::vector<float>& vertices, std::uint32_t first,
                              std::uint32_t capacity) {
    record.first_vertex = first;
    if (record.vertex_count <= capacity) {
        std::copy(vertices.begin(), vertices.end(), vertices_.begin() + 3 * static_cast<std::ptrdiff_t>(first));
    } else {
        const std::size_t end = vertices_.size() / 3;
        if (end + record.vertex_count > no_row)
            throw Error(ErrorCode::LimitExceeded,
                        "the outermost points of the scene's hulls and meshes are more than 4294967295");
        vertices_.insert(vertices_.end(), vertices.begin(), vertices.end());
        record.first_vertex = static_cast<std::uint32_t>(end);
    }
    used_ += record.vertex_count;
}

void ShapeStore::pack(std::uint64_t version) {
    std::vector<float> packed;
    packed.reserve(3 * used_);
    for (std::size_t i = 0; i < shapes_.size(); ++i) {
        ShapeRecord& record = records_[i];
        const auto begin = vertices_.begin() + 3 * static_cast<std::ptrdiff_t>(record.first_vertex);
        record.first_vertex = static_cast<std::uint32_t>(packed.size() / 3);
        packed.insert(packed.end(), begin, begin + 3 * static_cast<std::ptrdiff_t>(record.vertex_count));
        capacity_[i] = record.vertex_count;
        shapes_[i].version = version;
    }
    vertices_ = std::move(packed);
}

}  // namespace clinch::detail
