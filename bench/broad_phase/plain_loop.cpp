#include "bench/broad_phase/plain_loop.hpp"

namespace clinch::bench {

std::uint64_t count_overlaps(const std::vector<float>* columns, std::size_t n) {
    const float* const min_x = columns[0].data();
    const float* const min_y = columns[1].data();
    const float* const min_z = columns[2].data();
    const float* const max_x = columns[3].data();
    const float* const max_y = columns[4].data();
    const float* const max_z = columns[5].data();
    std::uint64_t total = 0;
    for (std::size_t a = 0; a < n; ++a) {
        const float ax = min_x[a], ay = min_y[a], az = min_z[a], bx = max_x[a], by = max_y[a], bz = max_z[a];
        unsigned int hits = 0;
        for (std::size_t b = a + 1; b < n; ++b)
            hits += static_cast<unsigned int>((min_x[b] <= bx) & (min_y[b] <= by) & (min_z[b] <= bz) &
                                              (max_x[b] >= ax) & (max_y[b] >= ay) & (max_z[b] >= az));
        total += hits;
    }
    return total;
}

}  // namespace clinch::bench
