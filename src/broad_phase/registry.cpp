#include <cmath>
#include <limits>
#include <vector>

#include "clinch/error.hpp"
#include "src/broad_phase/algorithm.hpp"
#include "src/broad_phase/box_sample.hpp"
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
    {"brute", true, false, false, make_brute},
    {"bvh", true, false, true, make_bvh},
    {"grid", true, true, false, make_grid},
    {"host-brute", false, false, false, make_host_brute},
    {"host-sweep", false, false, false, make_host_sweep},
    {"sweep", true, false, false, make_sweep},
    {"sweep3", true, false, false, make_sweep3},
};

// The choice of "auto": what an algorithm takes in nanoseconds, on two cores of a CPU with AVX-512; the cheapest is
// taken. Tests are those of a sweep along one axis, pairs those that the last call found (0 at the first). Where
// keeping pairs from call to call pays, and it was told what changed, BroadPhase takes the incremental path before it
// comes here.
struct Price {
    const char* algorithm;
    double call, box, sweep_test, pair;
    std::uint64_t most_boxes;  // beyond them it is not asked
};
constexpr std::uint64_t any = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t most_boxes_swept = 32768;
constexpr Price prices[] = {
    {"host-sweep", 0.0, 18.0, 0.25, 20.0, most_boxes_swept},
    {"bvh", 250000.0, 45.0, 0.0, 3.0, any},
};
constexpr std::uint64_t boxes_before_device = 250;  // done before a device has started
// Up to so many boxes their tests are taken to be of the usual number without a look at them. Without boxes on the host
// to look at, those of more are taken to be too many.
constexpr std::uint64_t boxes_taken_as_usual = 1500, boxes_taken_as_usual_unseen = 2500;

constexpr std::size_t sample_size = 64;
using Sample = std::vector<Aabb>;

// The axis on which centres vary most, as host-sweep chooses it.
int axis_of_variance(const Sample& sample) {
    int axis = 0;
    double most = -1.0;
    for (int d = 0; d < 3; ++d) {
        double mean = 0.0, variance = 0.0;
        const auto centre = [d](const Aabb& b) {
            return 0.5 * static_cast<double>(b.min[d]) + 0.5 * static_cast<double>(b.max[d]);
        };
        for (const Aabb& box : sample) mean += centre(box) / static_cast<double>(sample.size());
        for (const Aabb& box : sample) variance += (centre(box) - mean) * (centre(box) - mean);
        if (variance > most) most = variance, axis = d;
    }
    return axis;
}

// How many tests a sweep takes, by a sample, whose pairs are counted that overlap on the axis.
double sweep_tests(View<const Aabb> boxes) {
    const Sample sample = sample_of(boxes, sample_size);
    if (sample.size() < 2) return 0.0;
    const int axis = axis_of_variance(sample);
    std::uint32_t overlaps = 0;
    for (std::size_t i = 0; i < sample.size(); ++i)
        for (std::size_t j = i + 1; j < sample.size(); ++j)
            if (sample[i].min[axis] <= sample[j].max[axis] && sample[j].min[axis] <= sample[i].max[axis]) ++overlaps;
    const double n = static_cast<double>(boxes.size()), s = static_cast<double>(sample.size());
    return overlaps / (s * (s - 1.0)) * n * n;
}

double price_of(const Price& price, double boxes, double tests, double pairs) {
    return price.call + price.box * boxes + price.sweep_test * tests + price.pair * pairs;
}

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

const AlgorithmRow& choose_algorithm(std::uint64_t count, std::uint64_t last_pairs, const DeviceInfo* device,
                                     View<const Aabb> boxes) {
    if (device == nullptr || count <= boxes_before_device) return algorithm_named("host-sweep");
    const double n = static_cast<double>(count), pairs = static_cast<double>(last_pairs);
    double tests = n * n / 16.0;
    if (boxes.empty() ? count > boxes_taken_as_usual_unseen : count > boxes_taken_as_usual && count <= most_boxes_swept)
        tests = boxes.empty() ? n * n : sweep_tests(boxes);
    const Price* best = std::end(prices) - 1;  // is asked for any number
    for (const Price& price : prices)
        if (count <= price.most_boxes && price_of(price, n, tests, pairs) < price_of(*best, n, tests, pairs))
            best = &price;
    return algorithm_named(best->algorithm);
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
