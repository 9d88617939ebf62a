#include "src/primitives/pair_sort.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "clinch/aabb.hpp"
#include "src/device/quirks.hpp"
#include "src/primitives/bits.hpp"

namespace clinch::detail {
namespace {

// Counters and lines of the buckets are private to a work-item: a CPU has them in its caches, a GPU has little room.
std::uint32_t most_bucket_bits(const DeviceInfo& info) {
    return info.lanes > 1 ? 12 : 8;
}

// Buckets that keep all cores busy and fit in their caches, but are not so many that they are short.
std::uint64_t buckets_wanted(const DeviceInfo& info, std::uint64_t count) {
    if (info.lanes == 1) return count / 1024;
    return std::min({std::max<std::uint64_t>(count / 32768, 16 * std::uint64_t{info.compute_units}), count / 1024,
                     std::uint64_t{1024}});
}

std::uint32_t runs_for(const DeviceInfo& info, std::uint64_t count) {
    return static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(count / 1024, 1, std::uint64_t{info.compute_units} * (info.lanes > 1 ? 2 : 64)));
}

}  // namespace

// Where loops end early: a bucket may hold more pairs than a loop has turns.
void PairSort::sort_on_host(const Buffer& pairs, std::uint64_t count) {
    std::vector<Pair> sorted(count);
    device_.read(pairs, sorted.data(), count * sizeof(Pair));
    std::sort(sorted.begin(), sorted.end());
    device_.write(pairs, sorted.data(), count * sizeof(Pair));
}

std::string PairSort::defines(bool packed) const {
    const DeviceInfo& info = device_.info();
    return std::string(packed ? "-DKEY=uint" : "-DKEY=ulong") +
           " -DMAX_BUCKETS=" + std::to_string(1u << most_bucket_bits(info)) +
           (info.lanes > 1 ? " -DDIGIT_BITS=11" : " -DDIGIT_BITS=8");
}

PairSort::Kernels& PairSort::kernels(bool packed) {
    Kernels& kernels = packed ? packed_ : wide_;
    if (kernels.count) return kernels;  // made last
    kernels.scatter = device_.kernel("primitives/pair_sort", "pair_scatter", defines(packed));
    kernels.buckets = device_.kernel("primitives/pair_sort", "pair_buckets", defines(packed));
    kernels.count = device_.kernel("primitives/pair_sort", "pair_count", defines(packed));
    return kernels;
}

PairSort::Shape PairSort::shape_for(std::uint64_t count, std::uint32_t bodies, const DeviceInfo& info) {
    const std::uint32_t bits = std::max(1u, bits_of(bodies - 1));
    const std::uint32_t least = bits - std::min(bits, most_bucket_bits(info));
    const auto buckets_at = [&](std::uint32_t shift) { return ((bodies - 1) >> shift) + 1; };
    std::uint32_t shift = bits - 1;
    for (const std::uint64_t wanted = buckets_wanted(info, count); shift > least && buckets_at(shift) < wanted;)
        --shift;
    // Keys of 32 bits are worth more buckets than wanted, unless most of those would be empty.
    const std::uint32_t fits = bits < 32 ? 32 - bits : 0;
    if (shift > fits && fits >= least && count / 4 >= buckets_at(fits)) shift = fits;
    return {runs_for(info, count), buckets_at(shift), shift, bits, shift + bits <= 32};
}

// The pairs as keys by bucket.
void PairSort::scatter(const Buffer& pairs, std::uint64_t count, const Shape& s) {
    Kernels& k = kernels(s.packed);
    const std::uint64_t per_run = (count + s.runs - 1) / s.runs;
    const std::size_t table = std::size_t{s.buckets} * s.runs * sizeof(std::uint32_t);
    // As long as the buffer of the pairs, so that it grows no more often than that one.
    device_.reserve(keys_, pairs.bytes() / sizeof(Pair) * (s.packed ? sizeof(std::uint32_t) : sizeof(std::uint64_t)),
                    "the sort of pairs");
    device_.reserve(counts_, table, "the counts of a sort");
    device_.reserve(offsets_, table, "the offsets of a sort");

    const std::size_t group = device_.group_size();
    const std::size_t groups = (s.runs + group - 1) / group;
    device_.launch(k.count.args(pairs, count, per_run, s.runs, s.buckets, s.shift, counts_), groups, group);
    scan_.exclusive(counts_, s.buckets * s.runs, offsets_);
    device_.launch(k.scatter.args(pairs, count, per_run, s.runs, s.buckets, s.shift, s.b_bits, offsets_, keys_), groups,
                   group);
}

void PairSort::sort(const Buffer& pairs, std::uint64_t count, std::uint32_t bodies) {
    if (count < 2) return;
    if (most_loop_iterations(device_.info()) != std::numeric_limits<std::uint32_t>::max()) {
        sort_on_host(pairs, count);
        return;
    }
    const Shape s = shape_for(count, bodies, device_.info());
    scatter(pairs, count, s);
    const std::size_t group = device_.group_size();
    device_.launch(kernels(s.packed).buckets.args(keys_, pairs, count, offsets_, s.runs, s.buckets, s.shift, s.b_bits),
                   (s.buckets + group - 1) / group, group);
}

bool PairSort::packs_on(const DeviceInfo& info) {
    return info.lanes > 1 && most_loop_iterations(info) == std::numeric_limits<std::uint32_t>::max();
}

std::optional<KeyLayout> PairSort::layout_for(std::uint64_t pairs, std::uint32_t bodies, const DeviceInfo& info) {
    const Shape s = shape_for(pairs, std::max(1u, bodies), info);
    if (!s.packed) return std::nullopt;
    return KeyLayout{s.buckets, s.shift, s.b_bits};
}

PairSort::Packed PairSort::sort_to_keys(const Buffer& pairs, std::uint64_t count, const KeyLayout& layout) {
    Packed packed{{}, std::vector<std::uint32_t>(layout.buckets + std::size_t{1}, 0)};
    if (count == 0) return packed;
    const Shape s{runs_for(device_.info(), count), layout.buckets, layout.shift, layout.b_bits, true};
    scatter(pairs, count, s);
    const std::size_t group = device_.group_size();
    if (!key_buckets_) key_buckets_ = device_.kernel("primitives/pair_sort", "key_buckets", defines(true));
    // The counts were used: their room takes the starts.
    device_.launch(key_buckets_.args(keys_, pairs, count, offsets_, s.runs, s.buckets, s.shift, s.b_bits, counts_),
                   (s.buckets + group - 1) / group, group);
    device_.read(counts_, packed.starts.data(), layout.buckets * sizeof(std::uint32_t));
    packed.starts.back() = static_cast<std::uint32_t>(count);
    packed.keys = device_.map(keys_, count * sizeof(std::uint32_t));
    return packed;
}

}  // namespace clinch::detail
