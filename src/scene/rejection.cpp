// Why a body is left out, in words, and the list of those that are.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "src/scene/scene_impl.hpp"
#include "src/scene/text.hpp"

namespace clinch::detail {
namespace {

std::string not_finite(const char* what, const Vec3& v) {
    const std::pair<const char*, double> axes[] = {{" x", v.x}, {" y", v.y}, {" z", v.z}};
    for (const auto& [axis, value] : axes) {
        if (!std::isfinite(value)) return text((what + std::string(axis)).c_str(), value, "finite");
    }
    return {};
}

std::string why_rotation(const Quat& q) {
    const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return "rotation has length " + text(length) + " and must be within 1e-3 of 1";
}

std::string why(const Scene::Impl& s, std::uint32_t row) {
    const unsigned faults = s.faults[row];
    if ((faults & bad_position) != 0u) return not_finite("position", s.position[row]);
    if ((faults & bad_rotation) != 0u) return why_rotation(s.rotation[row]);
    if ((faults & bad_velocity) != 0u) return not_finite("velocity", s.velocity[row]);
    if ((faults & bad_angular_velocity) != 0u) return not_finite("angular velocity", s.angular_velocity[row]);
    if ((faults & bad_margin) != 0u) return text("margin", s.margin[row], "finite and >= 0");
    if ((faults & bad_motion) != 0u)
        return "motion is " + std::to_string(static_cast<unsigned>(s.motion[row])) +
               " and must be 0 (static), 1 (kinematic), 2 (dynamic) or 3 (sleeping)";
    const StoredShape& shape = s.shapes[s.shape[row]];
    if ((faults & bad_shape) != 0u) return shape.why;
    const Vec3& p = s.position[row];
    const double reach = std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)}) + shape.reach + s.margin[row];
    return "position, size and margin together reach " + text(reach) + " and must stay within 1e38";
}

void sort_unique(std::vector<std::uint32_t>& rows) {
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
}

}  // namespace

RejectionList::RejectionList(const RejectionList& other) {
    const std::lock_guard<std::mutex> lock(other.mutex_);
    list_ = other.list_;
    pending_ = other.pending_;
}

void RejectionList::touch(std::uint32_t row) {
    if (!pending_.empty() && pending_.back() == row) return;
    // Rows noted again and again while nobody asks must not pile up.
    if (pending_.size() == pending_.capacity()) {
        sort_unique(pending_);
        pending_.reserve(std::max<std::size_t>(64, 2 * pending_.size()));
    }
    pending_.push_back(row);
}

const std::vector<Rejection>& RejectionList::get(const Scene::Impl& scene) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (pending_.empty()) return list_;
    sort_unique(pending_);
    std::vector<Rejection> merged;
    merged.reserve(list_.size() + pending_.size());
    auto old = list_.begin();
    for (const std::uint32_t row : pending_) {
        for (; old != list_.end() && old->body < row; ++old) merged.push_back(std::move(*old));
        if (old != list_.end() && old->body == row) ++old;
        if (scene.alive[row] != 0 && scene.faults[row] != 0) merged.push_back({row, why(scene, row)});
    }
    std::move(old, list_.end(), std::back_inserter(merged));
    list_ = std::move(merged);
    pending_.clear();
    return list_;
}

}  // namespace clinch::detail
