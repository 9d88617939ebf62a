// The bulk setters of Scene.
#include <algorithm>
#include <cstring>
#include <string>

#include "clinch/error.hpp"
#include "clinch/scene.hpp"
#include "src/scene/same_bits.hpp"
#include "src/scene/scene_impl.hpp"

namespace clinch {
namespace {

// Throws unless rows first .. first + count - 1 are living bodies and there is an array to read.
void require_rows(const Scene::Impl& s, const void* array, std::size_t count, std::size_t first) {
    if (count > s.row_count() || first > s.row_count() - count)
        throw Error(ErrorCode::InvalidArgument, "rows " + std::to_string(first) + " to " + std::to_string(first) +
                                                    " + " + std::to_string(count) + " do not exist: the scene has " +
                                                    std::to_string(s.row_count()) + " rows");
    if (count > 0 && array == nullptr)
        throw Error(ErrorCode::InvalidArgument, "the array of new values is a null pointer");
    const auto begin = s.alive.begin() + static_cast<std::ptrdiff_t>(first);
    const auto dead = std::find(begin, begin + static_cast<std::ptrdiff_t>(count), 0);
    if (dead != begin + static_cast<std::ptrdiff_t>(count))
        throw Error(ErrorCode::InvalidArgument,
                    "row " + std::to_string(dead - s.alive.begin()) + " does not exist: its body was removed");
}

// Calls change(row, value) for each row whose value differs in any bit, after raising the version once.
template <class T, class Get, class Change>
void change_rows(Scene::Impl& s, const std::vector<T>& column, std::size_t count, std::size_t first, const Get& get,
                 const Change& change) {
    bool raised = false;
    for (std::size_t i = 0; i < count; ++i) {
        const T value = get(i);
        if (detail::same_bits(value, column[first + i])) continue;
        if (!raised) ++s.version;
        raised = true;
        change(static_cast<std::uint32_t>(first + i), value);
    }
}

// Rows of `width` numbers of type N into a column of T.
template <std::size_t width, class T, class N>
void set_numbers(Scene::Impl& s, std::vector<T>& column, const N* numbers, std::size_t count, std::size_t first,
                 unsigned faults, bool moves_box) {
    require_rows(s, numbers, count, first);
    static_assert(sizeof(T) == width * sizeof(double), "a row of the column is its numbers and nothing else");
    const auto get = [&](std::size_t i) {
        double row[width];
        for (std::size_t k = 0; k < width; ++k) row[k] = static_cast<double>(numbers[width * i + k]);
        T value;
        std::memcpy(&value, row, sizeof value);
        return value;
    };
    change_rows(s, column, count, first, get, [&](std::uint32_t row, const T& value) {
        column[row] = value;
        s.check(row, faults);
        if (moves_box) s.mark(row);
    });
}

constexpr unsigned position_faults = detail::bad_position | detail::bad_reach;

}  // namespace

void Scene::set_positions(const double* xyz, std::size_t count, std::size_t first) {
    set_numbers<3>(*impl_, impl_->position, xyz, count, first, position_faults, true);
}
void Scene::set_positions(const float* xyz, std::size_t count, std::size_t first) {
    set_numbers<3>(*impl_, impl_->position, xyz, count, first, position_faults, true);
}
void Scene::set_rotations(const double* wxyz, std::size_t count, std::size_t first) {
    set_numbers<4>(*impl_, impl_->rotation, wxyz, count, first, detail::bad_rotation, true);
}
void Scene::set_rotations(const float* wxyz, std::size_t count, std::size_t first) {
    set_numbers<4>(*impl_, impl_->rotation, wxyz, count, first, detail::bad_rotation, true);
}
void Scene::set_velocities(const double* xyz, std::size_t count, std::size_t first) {
    set_numbers<3>(*impl_, impl_->velocity, xyz, count, first, detail::bad_velocity, false);
}
void Scene::set_angular_velocities(const double* xyz, std::size_t count, std::size_t first) {
    set_numbers<3>(*impl_, impl_->angular_velocity, xyz, count, first, detail::bad_angular_velocity, false);
}
void Scene::set_margins(const double* margin, std::size_t count, std::size_t first) {
    set_numbers<1>(*impl_, impl_->margin, margin, count, first, detail::bad_margin | detail::bad_reach, true);
}

void Scene::set_shapes(const std::uint32_t* shape, std::size_t count, std::size_t first) {
    Impl& s = *impl_;
    require_rows(s, shape, count, first);
    for (std::size_t i = 0; i < count; ++i) {
        if (shape[i] >= s.shapes.size())
            throw Error(ErrorCode::InvalidArgument, "shape " + std::to_string(shape[i]) + " of row " +
                                                        std::to_string(first + i) + " does not exist: the scene has " +
                                                        std::to_string(s.shapes.size()) + " shapes");
    }
    change_rows(
        s, s.shape, count, first, [&](std::size_t i) { return shape[i]; },
        [&](std::uint32_t row, std::uint32_t value) { s.set_row_shape(row, value); });
}

void Scene::set_motions(const Motion* motion, std::size_t count, std::size_t first) {
    Impl& s = *impl_;
    require_rows(s, motion, count, first);
    change_rows(
        s, s.motion, count, first, [&](std::size_t i) { return motion[i]; },
        [&](std::uint32_t row, Motion value) { s.set_row_motion(row, value); });
}

void Scene::set_filters(const std::uint32_t* group, const std::uint32_t* mask, std::size_t count, std::size_t first) {
    Impl& s = *impl_;
    require_rows(s, group, count, first);
    require_rows(s, mask, count, first);
    bool raised = false;
    for (std::size_t i = 0; i < count; ++i) {
        const auto row = static_cast<std::uint32_t>(first + i);
        if (s.group[row] == group[i] && s.mask[row] == mask[i]) continue;
        if (!raised) ++s.version;
        raised = true;
        s.set_row_filter(row, group[i], mask[i]);
    }
}

}  // namespace clinch
