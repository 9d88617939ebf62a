#include "src/scene/scene_impl.hpp"

#include <algorithm>
#include <cmath>

namespace clinch {
namespace {

bool finite(const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
double largest(const Vec3& v) {
    return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

}  // namespace

void Scene::Impl::resize(std::size_t rows) {
    const std::size_t chunks = (rows + chunk_rows - 1) / chunk_rows;
    // All memory first, so that a failure leaves every column as it was.
    const auto reserve = [](auto& column, std::size_t n) {
        if (column.capacity() < n) column.reserve(std::max(n, column.capacity() + column.capacity() / 2));
    };
    each_column([&](auto& column) { reserve(column, rows); });
    reserve(chunk_version, chunks);
    each_column([&](auto& column) { column.resize(rows); });
    chunk_version.resize(chunks);
}

void Scene::Impl::fill(std::uint32_t row, const Body& body) {
    position[row] = body.pose.position;
    rotation[row] = body.pose.rotation;
    velocity[row] = body.velocity;
    angular_velocity[row] = body.angular_velocity;
    shape[row] = body.shape.index;
    group[row] = body.group;
    mask[row] = body.mask;
    motion[row] = body.motion;
    margin[row] = body.margin;
    faults[row] = 0;
    alive[row] = 1;
    filter_version = version;
    if (is_special(row)) ++special_filters;
    link(row);
    check(row, 0xffu);
    update_planes(row);
    mark(row);
}

void Scene::Impl::remove(std::uint32_t row) {
    if (is_special(row)) --special_filters;
    if (faults[row] != 0) rejections.touch(row);
    alive[row] = 0;
    unlink(row);
    update_planes(row);
    mark(row);
}

void Scene::Impl::set_row_shape(std::uint32_t row, std::uint32_t new_shape) {
    unlink(row);
    shape[row] = new_shape;
    link(row);
    check(row, detail::bad_shape | detail::bad_reach);
    update_planes(row);
    mark(row);
}

void Scene::Impl::set_row_filter(std::uint32_t row, std::uint32_t new_group, std::uint32_t new_mask) {
    if (is_special(row)) --special_filters;
    group[row] = new_group;
    mask[row] = new_mask;
    if (is_special(row)) ++special_filters;
    filter_version = version;
}

void Scene::Impl::set_row_motion(std::uint32_t row, Motion new_motion) {
    if (is_special(row)) --special_filters;
    motion[row] = new_motion;
    if (is_special(row)) ++special_filters;
    filter_version = version;
    check(row, detail::bad_motion);
}

void Scene::Impl::mark(std::uint32_t row) {
    row_version[row] = version;
    chunk_version[row / chunk_rows] = version;
}

void Scene::Impl::check(std::uint32_t row, unsigned which) {
    const unsigned before = faults[row];
    const unsigned after = (before & ~which) | find_faults(row, which);
    if ((before | after) == 0u) return;
    faults[row] = static_cast<std::uint8_t>(after);
    rejections.touch(row);  // even with the same faults the numbers in the message may differ
    if ((before == 0u) != (after == 0u)) {
        mark(row);
        update_planes(row);
    }
}

void Scene::Impl::replace_shape(std::uint32_t id, Shape new_shape) {
    shapes.replace(id, std::move(new_shape), version);
    for (std::uint32_t row = shapes[id].first_row; row != detail::no_row; row = next_row[row]) {
        check(row, detail::bad_shape | detail::bad_reach);
        update_planes(row);
        mark(row);
    }
}

unsigned Scene::Impl::find_faults(std::size_t row, unsigned which) const {
    unsigned found = 0;
    const auto test = [&](detail::Fault fault, auto&& good) {
        if ((which & fault) != 0u && !good()) found |= fault;
    };
    test(detail::bad_position, [&] { return finite(position[row]); });
    test(detail::bad_rotation, [&] {
        const Quat& q = rotation[row];
        return std::fabs(std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z) - 1.0) <= 1e-3;
    });
    test(detail::bad_velocity, [&] { return finite(velocity[row]); });
    test(detail::bad_angular_velocity, [&] { return finite(angular_velocity[row]); });
    test(detail::bad_margin, [&] { return std::isfinite(margin[row]) && margin[row] >= 0.0; });
    test(detail::bad_motion, [&] { return static_cast<unsigned>(motion[row]) <= 3u; });
    test(detail::bad_shape, [&] { return shapes[shape[row]].why.empty(); });
    test(detail::bad_reach, [&] { return largest(position[row]) + shapes[shape[row]].reach + margin[row] <= 1e38; });
    return found;
}

bool Scene::Impl::is_special(std::size_t row) const {
    return group[row] != 1u || mask[row] != 0xffffffffu ||
           (motion[row] != Motion::Dynamic && motion[row] != Motion::Kinematic);
}

void Scene::Impl::link(std::uint32_t row) {
    std::uint32_t& first = shapes[shape[row]].first_row;
    next_row[row] = first;
    previous_row[row] = detail::no_row;
    if (first != detail::no_row) previous_row[first] = row;
    first = row;
}

void Scene::Impl::unlink(std::uint32_t row) {
    const std::uint32_t next = next_row[row], previous = previous_row[row];
    if (next != detail::no_row) previous_row[next] = previous;
    if (previous != detail::no_row)
        next_row[previous] = next;
    else
        shapes[shape[row]].first_row = next;
}

void Scene::Impl::update_planes(std::uint32_t row) {
    if (alive[row] != 0 && faults[row] == 0 && shapes[shape[row]].is_plane)
        planes.insert(row);
    else if (!planes.empty())
        planes.erase(row);
}

}  // namespace clinch
