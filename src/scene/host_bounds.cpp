#include <cstddef>
#include <cstring>

#include "src/primitives/host_parallel.hpp"
#include "src/scene/bounds.hpp"
#include "src/scene/scene_impl.hpp"

namespace clinch::detail {

static_assert(sizeof(BoxRecord) == sizeof(Aabb), "the kernel's box is the public one");

std::size_t HostBounds::update(const Scene& scene) {
    const View<const std::uint32_t> rows = tracker_.changed(scene, false);
    tracker_.forget();  // should anything below throw, the next update starts afresh
    boxes_.resize(scene.row_count());
    records_.resize(rows.size());
    gather_records(scene, rows, records_.data());
    const ShapeStore& shapes = scene.impl().shapes;
    parallel_rows(rows.size(), 4096, [&](std::size_t i) {
        const BodyRecord& record = records_[i];
        BoxRecord box;
        clinch_bounds(&record, shapes.records().data(), shapes.vertices().data(), &box);
        std::memcpy(&boxes_[record.row], &box, sizeof box);
    });
    tracker_.seen(scene);
    return rows.size();
}

}  // namespace clinch::detail
