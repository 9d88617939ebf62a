#include "src/primitives/reduce.hpp"

#include <algorithm>
#include <string>

#include "src/device/quirks.hpp"

namespace clinch::detail {
namespace {

// Values a run: a few runs for each unit of a CPU, enough work-items for a GPU; a multiple of every number of lanes.
std::uint32_t run_length(const DeviceInfo& info, std::uint32_t n) {
    const std::uint32_t runs = std::max(1u, info.compute_units * (info.lanes > 1 ? 4u : 256u));
    const std::uint32_t most = std::min(most_loop_iterations(info) / 4, std::uint32_t{1} << 30);
    return (std::clamp(n / runs + 1, 256u, most) + 15) / 16 * 16;
}

}  // namespace

void Reduce::run(const Buffer& in, std::uint32_t n) {
    if (!runs_kernel_) {  // made last
        const std::string defines = std::string(value_ == Value::Float ? "-DVALUE=float" : "-DVALUE=uint") +
                                    " -DOPERATION=" + std::to_string(static_cast<int>(operation_));
        last_kernel_ = device_.kernel("primitives/reduce", "reduce_last", defines);
        result_ = device_.allocate(sizeof(std::uint32_t), "the result of a reduction");
        runs_kernel_ = device_.kernel("primitives/reduce", "reduce_runs", defines);
    }
    const std::uint32_t per_run = run_length(device_.info(), n);
    const std::uint32_t runs = n == 0 ? 0 : (n - 1) / per_run + 1;
    const std::size_t group = device_.group_size();
    device_.reserve(parts_, sizeof(std::uint32_t) * runs, "the runs of a reduction");
    device_.launch(runs_kernel_.args(in, n, per_run, runs, parts_), (runs + group - 1) / group, group);
    device_.launch(last_kernel_.args(parts_, runs, result_, LocalMemory{sizeof(std::uint32_t) * group}), 1, group);
}

std::uint32_t Reduce::as_uint() {
    std::uint32_t value = 0;
    device_.read(result_, &value, sizeof value);
    return value;
}

float Reduce::as_float() {
    float value = 0.0f;
    device_.read(result_, &value, sizeof value);
    return value;
}

}  // namespace clinch::detail
