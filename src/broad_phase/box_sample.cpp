#include "src/broad_phase/box_sample.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "src/primitives/host_parallel.hpp"

namespace clinch::detail {

namespace {

bool is_box(const Aabb& box) {
    bool valid = true;
    for (int d = 0; d < 3; ++d)
        valid = valid && std::isfinite(box.min[d]) && std::isfinite(box.max[d]) && box.min[d] <= box.max[d];
    return valid;
}

}  // namespace

std::vector<Aabb> sample_of(View<const Aabb> boxes, std::size_t size) {
    std::vector<Aabb> sample;
    sample.reserve(size);
    std::uint32_t random = 1;
    for (std::size_t k = 0; k < size && !boxes.empty(); ++k) {
        random = random * 1664525u + 1013904223u;  // [Knuth, The Art of Computer Programming 2, 3.3.4]
        const Aabb& box = boxes[static_cast<std::size_t>(std::uint64_t{random} * boxes.size() >> 32)];
        if (is_box(box)) sample.push_back(box);
    }
    return sample;
}

std::vector<float> centres_of(View<const Aabb> boxes, int axis, std::size_t size) {
    constexpr std::size_t least_for_threads = 16384;
    size = std::min(size, boxes.size());
    std::vector<float> centres(size);
    if (size == 0) return centres;
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    const std::uint64_t stretch = (std::uint64_t{boxes.size()} << 32) / size;  // its length, in parts of 2^-32
    parallel_rows(size, least_for_threads, [&](std::size_t k) {
        // Multiples of the golden section [Knuth, The Art of Computer Programming 3, 6.4].
        const std::uint32_t random = static_cast<std::uint32_t>(k) * 2654435769u;
        const std::uint64_t within = (stretch >> 16) * (random >> 16);
        const Aabb& box = boxes[static_cast<std::size_t>((k * stretch + within) >> 32)];
        centres[k] = is_box(box) ? 0.5f * box.min[axis] + 0.5f * box.max[axis] : none;
    });
    centres.erase(std::remove_if(centres.begin(), centres.end(), [](float centre) { return std::isnan(centre); }),
                  centres.end());
    return centres;
}

}  // namespace clinch::detail
