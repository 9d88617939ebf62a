#include "src/primitives/radix_sort.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "src/device/quirks.hpp"

namespace clinch::detail {
namespace {

// Digits and runs. A core of a CPU scatters into 2048 streams best as long as its tables of pages and its caches hold
// what they write to, else into 256; a few long runs keep all cores busy. A GPU wants many short runs, whose counters
// then must be few.
struct Shape {
    unsigned most_digit_bits, digit_bits;
    std::uint32_t runs;
};

Shape shape_for(const DeviceInfo& info, std::uint32_t n, unsigned bits) {
    const std::uint32_t least = n / (most_loop_iterations(info) / 4) + 1;  // no run may be longer than a loop
    if (info.lanes == 1) return {4, 4, std::max(least, std::clamp(n / 256, 1u, 256 * info.compute_units))};
    const unsigned most = n >= 16384 && n <= 524288 ? 11 : 8;
    const unsigned passes = (bits + most - 1) / most;
    return {11, (bits + passes - 1) / passes, std::max(least, std::clamp(n / 2048, 1u, 2 * info.compute_units))};
}

}  // namespace

void RadixSort::sort(Buffer& keys, Buffer& payload, std::uint32_t n, unsigned bits, bool number) {
    bits = std::max(bits, 1u);
    const Shape shape = shape_for(device_.info(), n, bits);
    if (!count_kernel_) {  // made last
        const std::string defines =
            "-DRADIX_BITS=" + std::to_string(shape.most_digit_bits) + (key_ == Key::Bits64 ? " -DKEY=ulong" : "");
        scatter_kernel_ = device_.kernel("primitives/radix_sort", "radix_scatter", defines);
        count_kernel_ = device_.kernel("primitives/radix_sort", "radix_count", defines);
    }
    const std::uint32_t digits = 1u << shape.digit_bits;
    const std::size_t table = std::size_t{shape.runs} * digits * sizeof(std::uint32_t);
    device_.reserve(other_keys_, keys.bytes(), "the sort of keys");
    device_.reserve(other_payload_, payload.bytes(), "the sort of a payload");
    device_.reserve(counts_, table, "the counts of a sort");
    device_.reserve(offsets_, table, "the offsets of a sort");
    const std::uint32_t per_run = n / shape.runs + 1;
    const std::size_t group = device_.group_size();
    const std::size_t groups = (shape.runs + group - 1) / group;
    for (unsigned shift = 0; shift < bits; shift += shape.digit_bits) {
        device_.launch(count_kernel_.args(keys, n, per_run, shape.runs, shift, digits, counts_), groups, group);
        scan_.exclusive(counts_, shape.runs * digits, offsets_);
        const std::uint32_t numbers = number && shift == 0 ? 1u : 0u;
        device_.launch(scatter_kernel_.args(keys, payload, n, per_run, shape.runs, shift, digits, offsets_, other_keys_,
                                            other_payload_, numbers),
                       groups, group);
        std::swap(keys, other_keys_);
        std::swap(payload, other_payload_);
    }
}

}  // namespace clinch::detail
