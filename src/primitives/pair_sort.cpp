#include "src/primitives/pair_sort.hpp"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "clinch/aabb.hpp"
#include "src/device/quirks.hpp"

namespace clinch::detail {
namespace {

constexpr std::uint32_t buckets = 256;  // BUCKETS of the kernel

std::uint32_t bits_of(std::uint32_t value) {
    std::uint32_t bits = 0;
    for (; value != 0; value >>= 1) ++bits;
    return bits;
}

}  // namespace

// Where loops end early: a bucket may hold more pairs than a loop has turns.
void PairSort::sort_on_host(const Buffer& pairs, std::uint64_t count) {
    std::vector<Pair> sorted(count);
    device_.read(pairs, sorted.data(), count * sizeof(Pair));
    std::sort(sorted.begin(), sorted.end());
    device_.write(pairs, sorted.data(), count * sizeof(Pair));
}

void PairSort::sort(Buffer& pairs, std::uint64_t count, std::uint32_t bodies) {
    if (count < 2) return;
    if (most_loop_iterations(device_.info()) != std::numeric_limits<std::uint32_t>::max()) {
        sort_on_host(pairs, count);
        return;
    }
    if (!count_kernel_) {
        count_kernel_ = device_.kernel("primitives/pair_sort", "pair_count");
        scatter_kernel_ = device_.kernel("primitives/pair_sort", "pair_scatter");
        buckets_kernel_ = device_.kernel("primitives/pair_sort", "pair_buckets");
    }
    const DeviceInfo& info = device_.info();
    const std::uint32_t bits = std::max(1u, bits_of(bodies - 1));
    const std::uint32_t shift = bits > 8 ? bits - 8 : 0;
    const auto runs = static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(count / 1024, 1, std::uint64_t{info.compute_units} * (info.lanes > 1 ? 2 : 64)));
    const std::uint64_t per_run = (count + runs - 1) / runs;
    const std::size_t table = std::size_t{buckets} * runs * sizeof(std::uint32_t);
    device_.reserve(other_, pairs.bytes(), "the sort of pairs");
    device_.reserve(counts_, table, "the counts of a sort");
    device_.reserve(offsets_, table, "the offsets of a sort");

    const std::size_t group = device_.group_size();
    device_.launch(count_kernel_.args(pairs, count, per_run, runs, shift, counts_), (runs + group - 1) / group, group);
    scan_.exclusive(counts_, buckets * runs, offsets_);
    device_.launch(scatter_kernel_.args(pairs, count, per_run, runs, shift, offsets_, other_),
                   (runs + group - 1) / group, group);
    // What is left of a below the bucket's bits, and all of b.
    const std::uint32_t key_bits = shift + bits;
    device_.launch(buckets_kernel_.args(other_, pairs, count, offsets_, runs, bits, key_bits), buckets / group, group);
    if ((key_bits + 7) / 8 % 2 == 0) std::swap(pairs, other_);
}

}  // namespace clinch::detail
