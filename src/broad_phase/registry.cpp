#include <algorithm>
#include <limits>

#include "clinch/error.hpp"
#include "src/broad_phase/algorithm.hpp"
#include "src/device/quirks.hpp"

namespace clinch::detail {

std::unique_ptr<BroadPhaseAlgorithm> make_brute(Device* device, const BroadPhaseOptions& options);
std::unique_ptr<BroadPhaseAlgorithm> make_bvh(Device* device, const BroadPhaseOptions& options);
std::unique_ptr<BroadPhaseAlgorithm> make_grid(Device* device, const BroadPhaseOptions& options);
std::unique_ptr<BroadPhaseAlgorithm> make_host_brute(Device* device, const BroadPhaseOptions& options);
std::unique_ptr<BroadPhaseAlgorithm> make_host_sweep(Device* device, const BroadPhaseOptions& options);
std::unique_ptr<BroadPhaseAlgorithm> make_sweep(Device* device, const BroadPhaseOptions& options);
std::unique_ptr<BroadPhaseAlgorithm> make_sweep3(Device* device, const BroadPhaseOptions& options);

namespace {

const AlgorithmRow rows[] = {
    {"brute", true, false, make_brute},
    {"bvh", true, false, make_bvh},
    {"grid", true, true, make_grid},
    {"host-brute", false, false, make_host_brute},
    {"host-sweep", false, false, make_host_sweep},
    {"sweep", true, false, make_sweep},
    {"sweep3", true, false, make_sweep3},
};

// The choice of "auto", first row that fits. Boxes, and pairs that the last call found a box (0 at the first): many
// pairs tell of a crowd, where the host has too much to test. Where keeping pairs from call to call pays, and it was
// told what changed, BroadPhase takes the incremental path before it comes here.
struct Preference {
    std::uint64_t boxes_up_to, pairs_a_box_up_to;
    const char* algorithm;
};
constexpr std::uint64_t any = UINT64_MAX;
constexpr Preference preferences[] = {
    {250, any, "host-sweep"},  // done before a device has started
    {2500, 50, "host-sweep"},
    {any, any, "bvh"},
};

}  // namespace

View<const AlgorithmRow> registry() {
    return {rows, std::size(rows)};
}

const AlgorithmRow& algorithm_named(const std::string& name) {
    std::string known = "auto";
    for (const AlgorithmRow& row : rows) {
        if (name == row.name) return row;
        known += std::string(", ") + row.name;
    }
    throw Error(ErrorCode::InvalidArgument, "there is no broad-phase algorithm '" + name + "'; accepted are " + known);
}

bool runs_on(const AlgorithmRow& row, const DeviceInfo& device) {
    return !row.long_loops || most_loop_iterations(device) == std::numeric_limits<std::uint32_t>::max();
}

const AlgorithmRow& choose_algorithm(std::uint64_t count, std::uint64_t last_pairs, const DeviceInfo* device) {
    if (device == nullptr) return algorithm_named("host-sweep");
    for (const Preference& row : preferences)
        if (count <= row.boxes_up_to && last_pairs / std::max<std::uint64_t>(count, 1) <= row.pairs_a_box_up_to)
            return algorithm_named(row.algorithm);
    return algorithm_named("brute");  // not reached: the last row fits all
}

void check_limit(std::uint64_t pairs, const BroadPhaseOptions& options) {
    if (pairs <= options.max_pairs) return;
    throw Error(ErrorCode::LimitExceeded, "there are " + std::to_string(pairs) + " pairs and at most " +
                                              std::to_string(options.max_pairs) + " are allowed (max_pairs)");
}

}  // namespace clinch::detail

namespace clinch {

std::vector<std::string> broad_phase_names() {
    std::vector<std::string> names;
    for (const detail::AlgorithmRow& row : detail::registry()) names.emplace_back(row.name);
    return names;
}

}  // namespace clinch
