#include "src/broad_phase/planes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "src/primitives/host_parallel.hpp"

namespace clinch::detail {
namespace {

using std::fabs;  // as OpenCL C calls it
#include "cl/common/half_space.clh"

constexpr std::size_t serial_words = 256;  // below this, threads cost more than they bring

// v rotated by the quaternion, which is normalised.
Vec3 rotate(Quat q, const Vec3& v) {
    const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    q = {q.w / length, q.x / length, q.y / length, q.z / length};
    // v + 2 w (u x v) + 2 u x (u x v)
    const Vec3 t{2 * (q.y * v.z - q.z * v.y), 2 * (q.z * v.x - q.x * v.z), 2 * (q.x * v.y - q.y * v.x)};
    return {v.x + q.w * t.x + q.y * t.z - q.z * t.y, v.y + q.w * t.y + q.z * t.x - q.x * t.z,
            v.z + q.w * t.z + q.x * t.y - q.y * t.x};
}

bool reaches(const WorldPlane& p, const Aabb& b) {
    return reaches_half_space(p.normal[0], p.normal[1], p.normal[2], p.offset, b.min[0], b.min[1], b.min[2], b.max[0],
                              b.max[1], b.max[2]) != 0;
}

}  // namespace

std::vector<WorldPlane> world_planes(const Scene& scene, View<const std::uint32_t> rows) {
    const SceneColumns columns = scene.columns();
    std::vector<WorldPlane> planes;
    for (const std::uint32_t row : rows) {
        const Plane& plane = std::get<Plane>(scene.shape({columns.shape[row]}));
        const Vec3 n = rotate(columns.rotation[row], plane.normal);
        const Vec3& p = columns.position[row];
        const double length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
        const double offset = plane.offset + (n.x * p.x + n.y * p.y + n.z * p.z) + columns.margin[row] * length;
        planes.push_back({row,
                          {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)},
                          static_cast<float>(offset)});
    }
    return planes;
}

void PlanePairs::expand(const std::vector<WorldPlane>& planes, const FilterInput& filters, FindCounts& counts) {
    pairs_.clear();
    for (std::size_t p = 0; p < planes.size(); ++p) {
        const std::uint32_t plane = planes[p].body;
        for (std::size_t w = 0; w < words_per_plane_; ++w) {
            for (std::uint32_t left = host_words_[p * words_per_plane_ + w], bit = 0; left != 0; left >>= 1, ++bit) {
                if ((left & 1) == 0) continue;
                const auto body = static_cast<std::uint32_t>(w * 32 + bit);
                if (!filters.allows(plane, body))
                    ++counts.pairs_filtered;
                else if (!filters.can_move(body))
                    ++counts.static_pairs;
                else
                    pairs_.push_back({std::min(plane, body), std::max(plane, body)});
            }
        }
    }
    std::sort(pairs_.begin(), pairs_.end());
}

const std::vector<Pair>& PlanePairs::find(const std::vector<WorldPlane>& planes, View<const Aabb> boxes,
                                          const FilterInput& filters, FindCounts& counts) {
    words_per_plane_ = (boxes.size() + 31) / 32;
    host_words_.assign(planes.size() * words_per_plane_, 0);
    parallel_for(host_words_.size(), host_words_.size() > serial_words, [&](std::size_t word) {
        const std::size_t first = word % words_per_plane_ * 32;
        const std::size_t end = std::min(boxes.size(), first + 32);
        for (std::size_t i = first; i < end; ++i)
            if (reaches(planes[word / words_per_plane_], boxes[i])) host_words_[word] |= 1u << (i - first);
    });
    expand(planes, filters, counts);
    return pairs_;
}

const std::vector<Pair>& PlanePairs::find(Device& device, const std::vector<WorldPlane>& planes, const Buffer& boxes,
                                          std::uint32_t n, const FilterInput& filters, FindCounts& counts) {
    if (!kernel_) kernel_ = device.kernel("broad_phase/planes", "planes_test");
    words_per_plane_ = (std::size_t{n} + 31) / 32;
    // A launch counts its words in 32 bits: so many planes at a time.
    const std::size_t at_once =
        std::max<std::size_t>(1, (std::size_t{1} << 24) / std::max<std::size_t>(1, words_per_plane_));
    host_words_.resize(planes.size() * words_per_plane_);
    for (std::size_t first = 0; first < planes.size(); first += at_once) {
        const std::size_t count = std::min(at_once, planes.size() - first);
        std::vector<std::array<float, 4>> rows;
        for (std::size_t p = first; p < first + count; ++p)
            rows.push_back({planes[p].normal[0], planes[p].normal[1], planes[p].normal[2], planes[p].offset});
        const std::size_t words = count * words_per_plane_;
        device.reserve(planes_, rows.size() * sizeof rows[0], "planes");
        device.write(planes_, rows.data(), rows.size() * sizeof rows[0]);
        device.reserve(words_, words * sizeof(std::uint32_t), "the bits of planes");
        kernel_.args(boxes, n, planes_, static_cast<std::uint32_t>(count), static_cast<std::uint32_t>(words_per_plane_),
                     words_);
        device.launch_items(kernel_, words);
        device.read(words_, host_words_.data() + first * words_per_plane_, words * sizeof(std::uint32_t));
    }
    expand(planes, filters, counts);
    return pairs_;
}

}  // namespace clinch::detail
