// From the scene's columns to the records that the bounds stage reads.
#include <cmath>
#include <cstddef>
#include <numeric>

#include "src/primitives/host_parallel.hpp"
#include "src/scene/bounds.hpp"
#include "src/scene/round_outward.hpp"
#include "src/scene/scene_impl.hpp"

namespace clinch::detail {
namespace {

constexpr std::size_t rows_worth_threads = 4096;

// Splits a coordinate into two floats, each 0 or at least smallest_length; true if their sum is exact.
bool split(double x, float& high, float& low) {
    high = static_cast<float>(x);
    if (std::fabs(high) < smallest_length) high = 0.0f;
    const double rest = x - static_cast<double>(high);  // exact
    low = static_cast<float>(rest);
    if (std::fabs(low) < smallest_length) low = 0.0f;
    return rest == static_cast<double>(low);
}

// True for the rotations that map axes to axes: 1, 2 or 4 components of equal size and the others 0.
bool maps_axes(const Quat& q) {
    const double c[] = {std::fabs(q.w), std::fabs(q.x), std::fabs(q.y), std::fabs(q.z)};
    const double largest = std::fmax(std::fmax(c[0], c[1]), std::fmax(c[2], c[3]));
    int equal = 0;
    for (const double x : c) {
        if (x != 0.0 && x != largest) return false;
        equal += x == largest ? 1 : 0;
    }
    return equal != 3;
}

// A component of the unit quaternion; tiny ones become 0.
float component(double x) {
    const auto f = static_cast<float>(x);
    return std::fabs(f) < 0x1p-40f ? 0.0f : f;
}

BodyRecord record_of(const Scene::Impl& s, std::uint32_t row) {
    BodyRecord r{};
    r.row = row;
    r.shape = s.shape[row];
    if (!s.row_usable(row)) {
        r.flags = CLINCH_NO_BOX;
        return r;
    }
    const Vec3& p = s.position[row];
    if (!split(p.x, r.high[0], r.low[0])) r.flags |= CLINCH_INEXACT_X;
    if (!split(p.y, r.high[1], r.low[1])) r.flags |= CLINCH_INEXACT_X << 1;
    if (!split(p.z, r.high[2], r.low[2])) r.flags |= CLINCH_INEXACT_X << 2;
    r.margin = length_up(s.margin[row]);
    // However a sphere is turned, it stays the same.
    const bool sphere = s.shapes.records()[r.shape].kind == CLINCH_SPHERE;
    const Quat q = sphere ? Quat{} : s.rotation[row];
    if (maps_axes(q)) r.flags |= CLINCH_AXES;
    const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    r.rotation[0] = component(q.w / length);
    r.rotation[1] = component(q.x / length);
    r.rotation[2] = component(q.y / length);
    r.rotation[3] = component(q.z / length);
    return r;
}

}  // namespace

void gather_records(const Scene& scene, View<const std::uint32_t> rows, BodyRecord* out) {
    const Scene::Impl& s = scene.impl();
    parallel_rows(rows.size(), rows_worth_threads, [&](std::size_t i) { out[i] = record_of(s, rows[i]); });
}

bool RowTracker::knows(const Scene& scene) const {
    return identity_ && identity_ == scene.impl().identity;
}

View<const std::uint32_t> RowTracker::changed(const Scene& scene, bool all) {
    rows_.clear();
    if (!all && knows(scene)) {
        scene.changed_rows(version_, rows_);
    } else {
        rows_.resize(scene.row_count());
        std::iota(rows_.begin(), rows_.end(), 0u);
    }
    return rows_;
}

void RowTracker::seen(const Scene& scene) {
    identity_ = scene.impl().identity;
    version_ = scene.version();
}

}  // namespace clinch::detail
