#include "clinch/scene.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "clinch/error.hpp"
#include "src/scene/scene_impl.hpp"

namespace clinch {
namespace {

constexpr std::size_t most_rows = 0xffffffffu;

void require_shape(const Scene::Impl& scene, std::uint32_t shape) {
    if (shape >= scene.shapes.size())
        throw Error(ErrorCode::InvalidArgument, "shape " + std::to_string(shape) + " does not exist: the scene has " +
                                                    std::to_string(scene.shapes.size()) + " shapes");
}

void require_body(const Scene& scene, BodyId id) {
    if (!scene.contains(id))
        throw Error(ErrorCode::InvalidArgument, "body " + std::to_string(id.index) + " does not exist: the scene has " +
                                                    std::to_string(scene.row_count()) +
                                                    " rows and this is none of them, or its body was removed");
}

std::unique_ptr<Scene::Impl> copy_of(const Scene::Impl& other) {
    auto copy = std::make_unique<Scene::Impl>(other);
    copy->identity = std::make_shared<const int>(0);
    return copy;
}

}  // namespace

Scene::Scene() : impl_(std::make_unique<Impl>()) {}
Scene::~Scene() = default;
Scene::Scene(const Scene& other) : impl_(copy_of(*other.impl_)) {}
Scene& Scene::operator=(const Scene& other) {
    if (this != &other) impl_ = copy_of(*other.impl_);
    return *this;
}
Scene::Scene(Scene&& other) noexcept = default;
Scene& Scene::operator=(Scene&& other) noexcept = default;

ShapeId Scene::add_shape(Shape shape) {
    impl_->shapes.add(std::move(shape), impl_->version + 1);
    ++impl_->version;
    return {static_cast<std::uint32_t>(impl_->shapes.size() - 1)};
}

void Scene::set_shape(ShapeId id, Shape shape) {
    require_shape(*impl_, id.index);
    ++impl_->version;
    impl_->replace_shape(id.index, std::move(shape));
}

const Shape& Scene::shape(ShapeId id) const {
    require_shape(*impl_, id.index);
    return impl_->shapes[id.index].shape;
}

std::size_t Scene::shape_count() const noexcept {
    return impl_->shapes.size();
}

BodyId Scene::add_body(const Body& body) {
    Impl& s = *impl_;
    if (s.free_rows.empty()) return add_bodies(1, body);
    require_shape(s, body.shape.index);
    const std::uint32_t row = s.free_rows.back();
    s.free_rows.pop_back();
    ++s.version;
    s.fill(row, body);
    return {row};
}

BodyId Scene::add_bodies(std::size_t count, const Body& body) {
    Impl& s = *impl_;
    require_shape(s, body.shape.index);
    const std::size_t first = s.row_count();
    if (count > most_rows - first)
        throw Error(ErrorCode::LimitExceeded, "the scene has " + std::to_string(first) + " rows and cannot take " +
                                                  std::to_string(count) + " more: 4294967295 is the most");
    if (count > 0) {
        s.resize(first + count);
        ++s.version;
        for (std::size_t row = first; row < first + count; ++row) s.fill(static_cast<std::uint32_t>(row), body);
    }
    return {static_cast<std::uint32_t>(first)};
}

void Scene::remove_body(BodyId id) {
    require_body(*this, id);
    Impl& s = *impl_;
    s.free_rows.push_back(id.index);
    ++s.version;
    s.remove(id.index);
}

bool Scene::contains(BodyId id) const noexcept {
    return id.index < impl_->alive.size() && impl_->alive[id.index] != 0;
}

Body Scene::body(BodyId id) const {
    require_body(*this, id);
    const Impl& s = *impl_;
    const std::uint32_t row = id.index;
    Body body;
    body.shape = {s.shape[row]};
    body.pose = {s.position[row], s.rotation[row]};
    body.velocity = s.velocity[row];
    body.angular_velocity = s.angular_velocity[row];
    body.motion = s.motion[row];
    body.group = s.group[row];
    body.mask = s.mask[row];
    body.margin = s.margin[row];
    return body;
}

void Scene::set_body(BodyId id, const Body& body) {
    require_body(*this, id);
    require_shape(*impl_, body.shape.index);
    set_pose(id, body.pose);
    set_velocities(&body.velocity.x, 1, id.index);
    set_angular_velocities(&body.angular_velocity.x, 1, id.index);
    set_shapes(&body.shape.index, 1, id.index);
    set_motion(id, body.motion);
    set_filter(id, body.group, body.mask);
    set_margins(&body.margin, 1, id.index);
}

void Scene::set_pose(BodyId id, const Pose& pose) {
    require_body(*this, id);
    set_positions(&pose.position.x, 1, id.index);
    set_rotations(&pose.rotation.w, 1, id.index);
}

void Scene::set_motion(BodyId id, Motion motion) {
    require_body(*this, id);
    set_motions(&motion, 1, id.index);
}

void Scene::set_filter(BodyId id, std::uint32_t group, std::uint32_t mask) {
    require_body(*this, id);
    set_filters(&group, &mask, 1, id.index);
}

std::size_t Scene::row_count() const noexcept {
    return impl_->row_count();
}
std::size_t Scene::body_count() const noexcept {
    return impl_->row_count() - impl_->free_rows.size();
}

SceneColumns Scene::columns() const noexcept {
    const Impl& s = *impl_;
    return {s.position, s.rotation, s.velocity, s.angular_velocity, s.shape,
            s.group,    s.mask,     s.motion,   s.margin,           s.alive};
}

const std::vector<Rejection>& Scene::rejected() const {
    return impl_->rejections.get(*impl_);
}

std::uint64_t Scene::version() const noexcept {
    return impl_->version;
}

std::uint64_t Scene::row_version(std::size_t row) const {
    if (row >= impl_->row_count())
        throw Error(ErrorCode::InvalidArgument, "row " + std::to_string(row) + " does not exist: the scene has " +
                                                    std::to_string(impl_->row_count()) + " rows");
    return impl_->row_version[row];
}

void Scene::changed_rows(std::uint64_t since, std::vector<std::uint32_t>& rows) const {
    const Impl& s = *impl_;
    for (std::size_t chunk = 0; chunk < s.chunk_version.size(); ++chunk) {
        if (s.chunk_version[chunk] <= since) continue;
        const std::size_t first = chunk * Impl::chunk_rows;
        const std::size_t last = std::min(first + Impl::chunk_rows, s.row_count());
        for (std::size_t row = first; row < last; ++row) {
            if (s.row_version[row] > since) rows.push_back(static_cast<std::uint32_t>(row));
        }
    }
}

std::uint64_t Scene::filter_version() const noexcept {
    return impl_->filter_version;
}

}  // namespace clinch
