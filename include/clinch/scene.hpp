// Bodies and shapes as columns, with a version a row so that only what changed travels to a device.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "clinch/pose.hpp"
#include "clinch/shape.hpp"
#include "clinch/view.hpp"

namespace clinch {

/// How a body moves. Two bodies are a candidate pair only if one of them is kinematic or dynamic.
enum class Motion : std::uint8_t { Static = 0, Kinematic = 1, Dynamic = 2, Sleeping = 3 };

/// Names a body: its row in every column and its number in every result. Stays the same while the
/// body lives; the row of a removed body is given to a later one.
struct BodyId {
    std::uint32_t index = 0;
};

/// What add_body takes; every field but the shape has the default of the scene file format.
struct Body {
    ShapeId shape{};
    Pose pose{};              ///< body to world
    Vec3 velocity{};          ///< units a second, world frame
    Vec3 angular_velocity{};  ///< radians a second about the world axes
    Motion motion = Motion::Dynamic;
    /// a and b may pair when (a.group & b.mask) && (b.group & a.mask).
    std::uint32_t group = 1;
    std::uint32_t mask = 0xffffffffu;
    double margin = 0.0;  ///< >= 0; the body's box grows by it on every side
};

/// A body that was left out of a step, and why ("rotation has length 2 and must be within 1e-3 of 1").
struct Rejection {
    std::uint32_t body = 0;
    std::string why;
};

/// The columns of a scene as they stand, one entry a row, valid until the scene changes.
/// Rows of removed bodies hold their last values and alive 0.
struct SceneColumns {
    View<const Vec3> position;
    View<const Quat> rotation;
    View<const Vec3> velocity;
    View<const Vec3> angular_velocity;
    View<const std::uint32_t> shape;
    View<const std::uint32_t> group;
    View<const std::uint32_t> mask;
    View<const Motion> motion;  ///< as given; a body with a Plane acts as Static
    View<const double> margin;
    View<const std::uint8_t> alive;
};

/// A set of bodies. A value type without a device: any number of pipelines may step the same scene.
/// Values that make a body meaningless (NaN, negative size, ...) are accepted here and reported by
/// rejected(); wrong calls (a body or shape that does not exist) throw Error InvalidArgument.
/// Not thread-safe: one thread changes a scene, or many read it. A copy has the same bodies, ids and
/// versions but counts as another scene; a moved-from scene may only be assigned to or destroyed.
class Scene {
public:
    Scene();
    ~Scene();
    Scene(const Scene& other);
    Scene& operator=(const Scene& other);
    Scene(Scene&& other) noexcept;
    Scene& operator=(Scene&& other) noexcept;

    /// Stores a shape and returns its name. Never rejects: bodies of a meaningless shape are. Cost:
    /// as why_invalid; of a Hull or Mesh, its outermost points are found once here.
    ShapeId add_shape(Shape shape);
    /// Replaces a shape; every body of it counts as changed (deforming bodies). Cost: as add_shape,
    /// plus the bodies of it.
    void set_shape(ShapeId id, Shape shape);
    const Shape& shape(ShapeId id) const;
    std::size_t shape_count() const noexcept;

    /// Adds a body in the row removed last, or in a new one. O(1). At most 2^32 - 1 rows: more is
    /// LimitExceeded.
    BodyId add_body(const Body& body);
    /// Adds `count` equal bodies in new rows, in order; returns the first. For bulk setters to fill.
    BodyId add_bodies(std::size_t count, const Body& body);
    /// Removes a body; the others keep their ids. O(1).
    void remove_body(BodyId id);
    /// True while `id` names a body that was added and not removed.
    bool contains(BodyId id) const noexcept;
    Body body(BodyId id) const;
    void set_body(BodyId id, const Body& body);
    void set_pose(BodyId id, const Pose& pose);
    void set_motion(BodyId id, Motion motion);
    void set_filter(BodyId id, std::uint32_t group, std::uint32_t mask);

    /// Bulk setters: `count` rows from row `first` on, from the caller's array of count x 3 numbers
    /// (x y z) or count x 4 (w x y z). The array is copied. Only rows whose numbers differ, in any bit, count as
    /// changed. Rows past the last, or of removed bodies, throw and change nothing.
    void set_positions(const double* xyz, std::size_t count, std::size_t first = 0);
    void set_positions(const float* xyz, std::size_t count, std::size_t first = 0);
    void set_rotations(const double* wxyz, std::size_t count, std::size_t first = 0);
    void set_rotations(const float* wxyz, std::size_t count, std::size_t first = 0);
    void set_velocities(const double* xyz, std::size_t count, std::size_t first = 0);
    void set_angular_velocities(const double* xyz, std::size_t count, std::size_t first = 0);
    void set_shapes(const std::uint32_t* shape, std::size_t count, std::size_t first = 0);
    void set_motions(const Motion* motion, std::size_t count, std::size_t first = 0);
    void set_filters(const std::uint32_t* group, const std::uint32_t* mask, std::size_t count, std::size_t first = 0);
    void set_margins(const double* margin, std::size_t count, std::size_t first = 0);

    /// Rows in every column: living bodies and rows waiting to be used again.
    std::size_t row_count() const noexcept;
    /// Living bodies.
    std::size_t body_count() const noexcept;
    SceneColumns columns() const noexcept;

    /// Bodies that a step leaves out, ascending by index, with the reason. Checks only rows changed
    /// since the last call; O(1) when none did.
    const std::vector<Rejection>& rejected() const;

    /// Grows with every change of anything; equal versions of one scene mean equal content.
    std::uint64_t version() const noexcept;
    /// version() of the last change of this row's shape, pose, margin or life (what its box needs), or
    /// of its being rejected or not. A row past the last is InvalidArgument.
    std::uint64_t row_version(std::size_t row) const;
    /// Appends to `rows` the rows whose row_version is greater than `since`, ascending. Cost: the
    /// changed rows, plus one look for every 1,024 rows.
    void changed_rows(std::uint64_t since, std::vector<std::uint32_t>& rows) const;
    /// version() of the last change of any group, mask or motion (a new body is one).
    std::uint64_t filter_version() const noexcept;

    /// The library's own view of this scene; not for users.
    struct Impl;
    const Impl& impl() const noexcept { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace clinch
