#include "src/primitives/scan.hpp"

#include <algorithm>

#include "src/device/quirks.hpp"

namespace clinch::detail {
namespace {

constexpr std::uint32_t shortest_run = 256;

// Runs: a few for each unit of a CPU, which reads a long run best; enough work-items for a GPU.
std::uint32_t run_length(const DeviceInfo& info, std::uint32_t n) {
    const std::uint32_t runs = std::max(1u, info.compute_units * (info.lanes > 1 ? 4u : 256u));
    return std::clamp(n / runs + 1, shortest_run, most_loop_iterations(info) / 4);
}

}  // namespace

void Scan::exclusive(const Buffer& in, std::uint32_t n, const Buffer& out) {
    if (!runs_kernel_) {  // made last, when all else is there
        sums_kernel_ = device_.kernel("primitives/scan", "scan_sums");
        offsets_kernel_ = device_.kernel("primitives/scan", "scan_offsets");
        total_ = device_.allocate(sizeof(std::uint32_t), "the sum of a scan");
        runs_kernel_ = device_.kernel("primitives/scan", "scan_runs");
    }
    const std::uint32_t per_run = run_length(device_.info(), n);
    const std::uint32_t runs = n == 0 ? 0 : (n - 1) / per_run + 1;
    const std::size_t group = device_.group_size();
    const std::size_t groups = (runs + group - 1) / group;
    device_.reserve(sums_, sizeof(std::uint32_t) * runs, "the runs of a scan");
    device_.launch(runs_kernel_.args(in, n, per_run, runs, sums_), groups, group);
    device_.launch(sums_kernel_.args(sums_, runs, total_, LocalMemory{sizeof(std::uint32_t) * group}), 1, group);
    device_.launch(offsets_kernel_.args(in, n, per_run, runs, sums_, out), groups, group);
}

std::uint32_t Scan::total() {
    std::uint32_t total = 0;
    device_.read(total_, &total, sizeof total);
    return total;
}

}  // namespace clinch::detail
