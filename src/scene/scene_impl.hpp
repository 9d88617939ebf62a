// What stands behind clinch::Scene: columns, versions, and what follows from them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

#include "clinch/scene.hpp"
#include "src/scene/shape_store.hpp"

namespace clinch {
namespace detail {

/// What makes a row's body meaningless, one bit a cause; listed in the order in which they are reported.
enum Fault : std::uint8_t {
    bad_position = 1,
    bad_rotation = 2,
    bad_velocity = 4,
    bad_angular_velocity = 8,
    bad_margin = 16,
    bad_motion = 32,
    bad_shape = 64,
    bad_reach = 128,  ///< the body sticks out of what float32 holds
};

/// The list that Scene::rejected() gives. Kept by the lock since many threads may read a scene.
class RejectionList {
public:
    RejectionList() = default;
    RejectionList(const RejectionList& other);
    RejectionList& operator=(const RejectionList&) = delete;

    /// Notes that this row's entry must be looked at again. Only the thread that changes the scene calls it.
    void touch(std::uint32_t row);
    /// The list as of now.
    const std::vector<Rejection>& get(const Scene::Impl& scene) const;

private:
    mutable std::mutex mutex_;
    mutable std::vector<Rejection> list_;
    mutable std::vector<std::uint32_t> pending_;
};

}  // namespace detail

struct Scene::Impl {
    Impl() = default;
    Impl(const Impl&) = default;
    Impl& operator=(const Impl&) = delete;

    // --- what the rest of the library reads ---

    /// Unique to this Scene: a copy gets its own (Scene's copying does that), a moved scene keeps it. Holding
    /// the pointer keeps the token from being given to another scene.
    std::shared_ptr<const int> identity = std::make_shared<const int>(0);
    /// Every living row has group 1, mask all ones and motion Dynamic or Kinematic. O(1).
    bool filters_default() const noexcept { return special_filters == 0; }
    /// Rows of living, not rejected bodies with a Plane, ascending. O(planes).
    std::vector<std::uint32_t> plane_rows() const { return {planes.begin(), planes.end()}; }
    /// True when the row has a box: a living body, not rejected, not a plane.
    bool row_usable(std::size_t row) const noexcept {
        return alive[row] != 0 && faults[row] == 0 && !shapes[shape[row]].is_plane;
    }
    std::size_t row_count() const noexcept { return alive.size(); }

    std::uint64_t version = 0;
    std::uint64_t filter_version = 0;
    detail::ShapeStore shapes;

    // Columns; those of SceneColumns first.
    std::vector<Vec3> position;
    std::vector<Quat> rotation;
    std::vector<Vec3> velocity;
    std::vector<Vec3> angular_velocity;
    std::vector<std::uint32_t> shape;
    std::vector<std::uint32_t> group;
    std::vector<std::uint32_t> mask;
    std::vector<Motion> motion;
    std::vector<double> margin;
    std::vector<std::uint8_t> alive;
    std::vector<std::uint8_t> faults;  // detail::Fault bits
    std::vector<std::uint64_t> row_version;
    std::vector<std::uint32_t> next_row;  // rows of the same shape, living ones only
    std::vector<std::uint32_t> previous_row;

    static constexpr std::size_t chunk_rows = 1024;
    std::vector<std::uint64_t> chunk_version;  // largest row_version of each chunk_rows rows
    std::vector<std::uint32_t> free_rows;
    std::set<std::uint32_t> planes;
    std::size_t special_filters = 0;  // living rows that are not as filters_default() says
    detail::RejectionList rejections;

    // --- changes; `version` was raised before ---

    /// Makes all columns `rows` long; the new rows are not alive.
    void resize(std::size_t rows);
    /// Fills a row that is not alive and brings it to life.
    void fill(std::uint32_t row, const Body& body);
    void remove(std::uint32_t row);
    void set_row_shape(std::uint32_t row, std::uint32_t new_shape);
    void set_row_filter(std::uint32_t row, std::uint32_t new_group, std::uint32_t new_mask);
    void set_row_motion(std::uint32_t row, Motion new_motion);
    /// The row's box needs to be made again.
    void mark(std::uint32_t row);
    /// Looks again at the causes in `which` (Fault bits) after their columns changed, and marks the row if
    /// its body became meaningless or ceased to be.
    void check(std::uint32_t row, unsigned which);
    void replace_shape(std::uint32_t id, Shape new_shape);

private:
    template <class F>
    void each_column(const F& f) {
        f(position), f(rotation), f(velocity), f(angular_velocity), f(shape), f(group), f(mask), f(motion), f(margin);
        f(alive), f(faults), f(row_version), f(next_row), f(previous_row);
    }
    unsigned find_faults(std::size_t row, unsigned which) const;
    bool is_special(std::size_t row) const;
    void link(std::uint32_t row);
    void unlink(std::uint32_t row);
    void update_planes(std::uint32_t row);
};

}  // namespace clinch
