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

// Up to here the host is done before a device has started: launching and waiting cost about as much as
// this many boxes against each other.
constexpr std::uint64_t host_boxes = 500;
// Up to here testing all pairs costs less than sorting boxes into cells.
constexpr std::uint64_t brute_boxes = 2000;

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

const AlgorithmRow& choose_algorithm(std::uint64_t count, const DeviceInfo* device) {
    if (device == nullptr || count <= host_boxes) return algorithm_named("host-brute");
    const AlgorithmRow& grid = algorithm_named("grid");
    return count > brute_boxes && runs_on(grid, *device) ? grid : algorithm_named("brute");
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
