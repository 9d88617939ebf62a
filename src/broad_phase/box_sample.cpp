#include "src/broad_phase/box_sample.hpp"

#include <cmath>
#include <cstdint>

namespace clinch::detail {

std::vector<Aabb> sample_of(View<const Aabb> boxes, std::size_t size) {
    std::vector<Aabb> sample;
    sample.reserve(size);
    std::uint32_t random = 1;
    for (std::size_t k = 0; k < size && !boxes.empty(); ++k) {
        random = random * 1664525u + 1013904223u;  // [Knuth, The Art of Computer Programming 2, 3.3.4]
        const Aabb& box = boxes[static_cast<std::size_t>(std::uint64_t{random} * boxes.size() >> 32)];
        bool valid = true;
        for (int d = 0; d < 3; ++d)
            valid = valid && std::isfinite(box.min[d]) && std::isfinite(box.max[d]) && box.min[d] <= box.max[d];
        if (valid) sample.push_back(box);
    }
    return sample;
}

}  // namespace clinch::detail
