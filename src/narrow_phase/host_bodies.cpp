#include "src/narrow_phase/host_bodies.hpp"

#include <algorithm>

#include "src/primitives/host_parallel.hpp"
#include "src/scene/round_outward.hpp"
#include "src/scene/scene_impl.hpp"

namespace clinch::detail {
namespace {

constexpr std::size_t rows_worth_threads = 4096;

// Row-major, body to world, computed in Real and rounded to To: with long double each entry is rounded once where that
// is longer than a double, else within 4 units of 2^-53.
template <class Real, class To>
void turn_of(const Quat& rotation, To* m) {
    const Real a = rotation.w, b = rotation.x, c = rotation.y, d = rotation.z;
    const Real one = 1, two = 2, s = two / (a * a + b * b + c * c + d * d);
    const Real turn[9] = {one - s * (c * c + d * d), s * (b * c - a * d),       s * (b * d + a * c),
                          s * (b * c + a * d),       one - s * (b * b + d * d), s * (c * d - a * b),
                          s * (b * d - a * c),       s * (c * d + a * b),       one - s * (b * b + c * c)};
    for (std::size_t i = 0; i < 9; ++i) m[i] = static_cast<To>(turn[i]);
}

bool in_use(const Scene::Impl& s, std::uint32_t row) {
    return s.alive[row] != 0 && s.faults[row] == 0;
}

void make_frame(const Scene& scene, std::uint32_t row, BodyFrame64& frame) {
    frame = frame_of(scene, row);
}
// What a float64 entry is off by is far less than the rounding to float32.
void make_frame(const Scene& scene, std::uint32_t row, BodyFrame32& frame) {
    const Scene::Impl& s = scene.impl();
    frame = {};
    frame.shape = s.shape[row];
    if (!in_use(s, row)) return;
    const Vec3& position = s.position[row];
    const double places[3] = {position.x, position.y, position.z};
    for (std::size_t d = 0; d < 3; ++d) {
        frame.high[d] = static_cast<float>(places[d]);
        frame.low[d] = static_cast<float>(places[d] - static_cast<double>(frame.high[d]));
    }
    turn_of<double>(s.rotation[row], frame.turn);
}

}  // namespace

BodyFrame64 frame_of(const Scene& scene, std::uint32_t row) {
    const Scene::Impl& s = scene.impl();
    BodyFrame64 frame{};
    frame.shape = s.shape[row];
    if (!in_use(s, row)) return frame;
    frame.position[0] = s.position[row].x;
    frame.position[1] = s.position[row].y;
    frame.position[2] = s.position[row].z;
    turn_of<long double>(s.rotation[row], frame.turn);
    return frame;
}

template <class Frame>
View<const Frame> HostBodies::update(const Scene& scene, Frames<Frame>& frames) {
    const std::lock_guard<std::mutex> lock(frames.mutex);
    const std::size_t rows_there = scene.row_count();
    const View<const std::uint32_t> rows = frames.tracker.changed(scene, frames.rows.size() != rows_there);
    frames.tracker.forget();  // until all went well
    frames.rows.resize(rows_there);
    parallel_rows(rows.size(), rows_worth_threads,
                  [&](std::size_t i) { make_frame(scene, rows[i], frames.rows[rows[i]]); });
    frames.tracker.seen(scene);
    return frames.rows;
}

View<const BodyFrame32> HostBodies::frames32(const Scene& scene) {
    return update(scene, frames32_);
}
View<const BodyFrame64> HostBodies::frames64(const Scene& scene) {
    return update(scene, frames64_);
}

HostBodies::Classes HostBodies::classes(const Scene& scene, const NarrowShapes& shapes) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const Scene::Impl& s = scene.impl();
    const std::size_t rows_there = scene.row_count();
    const bool afresh = classes_.size() != rows_there || !tracker_.knows(scene);
    const View<const std::uint32_t> rows = tracker_.changed(scene, afresh);
    if (afresh) {
        classes_.assign(rows_there, no_class);
        margins_.assign(rows_there, 0.0f);
        with_margin_ = 0;
        ++version_;
    }
    bool changed = false;
    for (const std::uint32_t row : rows) {
        const bool used = in_use(s, row);
        const auto now = used ? static_cast<std::uint8_t>(shapes.records()[s.shape[row]].kind) : no_class;
        const float margin = used ? length_up(s.margin[row]) : 0.0f;
        changed = changed || now != classes_[row] || !(margin == margins_[row]);
        with_margin_ += (margin > 0.0f ? 1U : 0U);
        with_margin_ -= (margins_[row] > 0.0f ? 1U : 0U);
        classes_[row] = now;
        margins_[row] = margin;
    }
    if (changed) ++version_;
    tracker_.seen(scene);
    return {classes_, with_margin_ > 0 ? View<const float>(margins_) : View<const float>(), version_};
}

}  // namespace clinch::detail
