// The yardstick of brute force: what one core does with a plain loop.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace clinch::bench {

/// Counts overlapping pairs among `n` boxes given as columns (min x, y, z, max x, y, z), each against
/// each later one, in a loop that the compiler turns into vector code for this machine. One thread. It only
/// counts: it writes no pair.
std::uint64_t count_overlaps(const std::vector<float>* columns, std::size_t n);

}  // namespace clinch::bench
