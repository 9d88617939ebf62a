#include "src/primitives/compact.hpp"

#include <algorithm>

#include "src/device/quirks.hpp"

namespace clinch::detail {
namespace {

// Entries a run. Where loops end early the 16 work-items of a vector wait for each other.
std::uint32_t run_length(const DeviceInfo& info, std::uint32_t n) {
    const std::uint32_t runs = std::max(1u, info.compute_units * (info.lanes > 1 ? 4u : 256u));
    const std::uint32_t most = std::min(most_loop_iterations(info) / (3 * 16), std::uint32_t{1} << 30);
    return (std::clamp(n / runs + 1, 256u, most) + 15) / 16 * 16;
}

}  // namespace

void Compact::values(const Buffer& flags, const Buffer& values, std::uint32_t n, const Buffer& out) {
    run(flags, values, n, out, false);
}

void Compact::numbers(const Buffer& flags, std::uint32_t n, const Buffer& out) {
    run(flags, flags, n, out, true);
}

void Compact::run(const Buffer& flags, const Buffer& values, std::uint32_t n, const Buffer& out, bool number) {
    if (!count_kernel_) {  // made last
        fill_kernel_ = device_.kernel("primitives/compact", "compact_fill");
        count_kernel_ = device_.kernel("primitives/compact", "compact_count");
    }
    const std::uint32_t per_run = run_length(device_.info(), n);
    const std::uint32_t runs = n == 0 ? 0 : (n - 1) / per_run + 1;
    const std::size_t group = device_.group_size();
    const std::size_t groups = (runs + group - 1) / group;
    device_.reserve(counts_, sizeof(std::uint32_t) * runs, "the runs of a compaction");
    device_.reserve(offsets_, sizeof(std::uint32_t) * runs, "the runs of a compaction");
    device_.launch(count_kernel_.args(flags, n, per_run, runs, counts_), groups, group);
    scan_.exclusive(counts_, runs, offsets_);
    device_.launch(fill_kernel_.args(flags, values, n, per_run, runs, offsets_, out, number ? 1u : 0u), groups, group);
}

}  // namespace clinch::detail
