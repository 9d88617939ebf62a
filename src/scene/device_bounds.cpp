#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "clinch/error.hpp"
#include "src/device/quirks.hpp"
#include "src/scene/bounds.hpp"
#include "src/scene/scene_impl.hpp"

namespace clinch::detail {

namespace {

// One work-item goes through all vertices of a shape, with up to four turns of a loop for each.
void check_vertex_count(std::uint32_t count, const DeviceInfo& info) {
    const std::uint32_t most = most_loop_iterations(info) / 4;
    if (count > most)
        throw Error(ErrorCode::DeviceFailed,
                    "a shape has " + std::to_string(count) + " outermost vertices, and the driver of '" + info.name +
                        "' (quirk loops-end-early) gets through at most " + std::to_string(most));
}

}  // namespace

std::size_t DeviceBounds::upload(const Scene& scene) {
    if (pending_ != 0) tracker_.forget();  // rows of the upload before were never computed
    pending_ = 0;
    sent_ = {};
    if (!tracker_.knows(scene)) shapes_sent_ = 0;
    try {
        const bool grown = grow(boxes_, scene.row_count() * sizeof(Aabb), "boxes");
        const View<const std::uint32_t> rows = tracker_.changed(scene, grown);
        if (!rows.empty()) send_rows(scene, rows);
        tracker_.seen(scene);
        pending_ = rows.size();
        sent_ = rows;
    } catch (...) {
        tracker_.forget();
        throw;
    }
    return pending_;
}

// Makes the buffer long enough; true if its content was lost. A buffer that grows takes half as much again, since
// all of its content is to be sent each time.
bool DeviceBounds::grow(Buffer& buffer, std::size_t bytes, const char* what) {
    if (buffer.handle() != nullptr && bytes <= buffer.bytes()) return false;
    device_.reserve(buffer, buffer.handle() == nullptr ? bytes : bytes + bytes / 2, what);
    return true;
}

void DeviceBounds::send_rows(const Scene& scene, View<const std::uint32_t> rows) {
    send_shapes(scene);
    staging_.resize(rows.size());
    gather_records(scene, rows, staging_.data());
    grow(records_, rows.size() * sizeof(BodyRecord), "body records");
    device_.write(records_, staging_.data(), rows.size() * sizeof(BodyRecord));
}

void DeviceBounds::send_shapes(const Scene& scene) {
    const ShapeStore& store = scene.impl().shapes;
    const bool records_grown = grow(shapes_, store.records().size() * sizeof(ShapeRecord), "shapes");
    const bool vertices_grown = grow(vertices_, store.vertices().size() * sizeof(float), "outermost vertices");
    const std::uint64_t seen = records_grown || vertices_grown ? 0 : shapes_sent_;
    if (store.version() <= seen) return;
    // One piece from the first to the last changed shape, and their vertices.
    std::size_t first = store.size(), last = 0, first_vertex = store.vertices().size() / 3, last_vertex = 0;
    for (std::size_t i = 0; i < store.size(); ++i) {
        if (store[i].version <= seen) continue;
        const ShapeRecord& record = store.records()[i];
        first = std::min(first, i);
        last = i + 1;
        if (record.vertex_count == 0) continue;
        check_vertex_count(record.vertex_count, device_.info());
        first_vertex = std::min<std::size_t>(first_vertex, record.first_vertex);
        last_vertex = std::max<std::size_t>(last_vertex, std::size_t{record.first_vertex} + record.vertex_count);
    }
    if (first < last)
        device_.write(shapes_, store.records().data() + first, (last - first) * sizeof(ShapeRecord),
                      first * sizeof(ShapeRecord));
    constexpr std::size_t vertex = 3 * sizeof(float);
    if (first_vertex < last_vertex)
        device_.write(vertices_, store.vertices().data() + 3 * first_vertex, (last_vertex - first_vertex) * vertex,
                      first_vertex * vertex);
    shapes_sent_ = store.version();
}

void DeviceBounds::compute() {
    if (pending_ == 0) return;
    try {
        if (!kernel_) kernel_ = device_.kernel("scene/bounds", "compute_bounds");
        kernel_.args(static_cast<cl_uint>(pending_), records_, shapes_, vertices_, boxes_);
        device_.launch_items(kernel_, pending_);
    } catch (...) {
        tracker_.forget();
        throw;
    }
    pending_ = 0;
}

}  // namespace clinch::detail
