#include <algorithm>

#include "clinch/error.hpp"
#include "src/broad_phase/algorithm.hpp"

namespace clinch::detail {

std::unique_ptr<BroadPhaseAlgorithm> make_brute(Device* device, const BroadPhaseOptions& options);
std::unique_ptr<BroadPhaseAlgorithm> make_host_brute(Device* device, const BroadPhaseOptions& options);

namespace {

const AlgorithmRow rows[] = {
    {"brute", true, make_brute},
    {"host-brute", false, make_host_brute},
};

// Up to here the host is done before a device has started: launching and waiting cost about as much as
// this many boxes against each other.
constexpr std::uint64_t host_boxes = 500;

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

const AlgorithmRow& choose_algorithm(std::uint64_t count, bool has_device) {
    return algorithm_named(has_device && count > host_boxes ? "brute" : "host-brute");
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
