// sweep: boxes sorted on the axis of the largest variance, each against those that begin before it ends. See
// cl/broad_phase/sweep.cl.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "src/broad_phase/algorithm.hpp"
#include "src/broad_phase/pair_sink.hpp"
#include "src/broad_phase/sweep_axis.hpp"
#include "src/device/quirks.hpp"
#include "src/primitives/radix_sort.hpp"

namespace clinch::detail {
namespace {

constexpr std::uint32_t padding = 64;  // entries behind the last that vector loads may touch

// How the turns of all boxes are cut into tasks.
struct Pieces {
    std::uint64_t turns;  // a piece
    std::uint32_t count;
    std::uint32_t most_tasks;  // a work-item; 0: any number
};

// Turns of loops that a work-item may make; on a device where loops end early, work-items that run as lanes of one
// vector wait for each other, so that their turns add up.
std::uint32_t loop_budget(const Device& device) {
    const std::uint32_t most = most_loop_iterations(device.info());
    if (most == std::numeric_limits<std::uint32_t>::max()) return most;
    return most / (device.group_size() > 1 ? 32 : 2);
}

Pieces cut(const Device& device, std::uint64_t turns) {
    const DeviceInfo& info = device.info();
    const std::uint64_t workers = std::uint64_t{info.compute_units} * (info.lanes > 1 ? 2 : 256);
    // Short enough for an even end, long enough to pay for the search of its beginning; fewer than 2^31 of them.
    Pieces pieces{std::clamp<std::uint64_t>(turns / (workers * 16), 64, 4096), 0, 0};
    const std::uint32_t budget = loop_budget(device);
    if (budget != std::numeric_limits<std::uint32_t>::max()) {
        // A turn may bring a pair in each lane; a task searches for its beginning twice.
        const std::uint64_t a_turn = info.lanes + 2, a_search = 128;
        pieces.turns = std::min<std::uint64_t>(pieces.turns, (budget - a_search) / a_turn);
        pieces.most_tasks = static_cast<std::uint32_t>(budget / (pieces.turns * a_turn + a_search));
        if (turns / pieces.turns >= std::uint64_t{1} << 31)
            throw Error(ErrorCode::DeviceFailed, "sweep has more work than '" + info.name +
                                                     "', whose driver has the quirk loops-end-early, can be given");
    } else {
        pieces.turns = std::max(pieces.turns, turns >> 31);
    }
    pieces.count = static_cast<std::uint32_t>((turns + pieces.turns - 1) / pieces.turns);
    return pieces;
}

class Sweep : public BroadPhaseAlgorithm {
public:
    Sweep(Device& device, const BroadPhaseOptions& options)
        : device_(device), axis_(device), sort_(device), sink_(device, options) {}

    void find(BoxInput& boxes, const FilterInput& filters, PairList& pairs, FindCounts& counts) override;

private:
    void line_up(BoxInput& boxes, const AxisChoice& choice);
    std::uint64_t find_ranges(std::uint32_t m);

    Device& device_;
    AxisChooser axis_;
    RadixSort sort_;
    PairSink sink_;
    Kernel keys_kernel_, gather_kernel_, ranges_kernel_, pairs_kernels_[2];
    Buffer keys_, order_, columns_, ends_, before_, run_turns_;
    std::uint64_t stride_ = 0;
    std::uint32_t per_run_ = 0, runs_ = 0;
};

// Sorts the boxes along the axis and lays them out as columns.
void Sweep::line_up(BoxInput& boxes, const AxisChoice& choice) {
    const std::uint32_t n = boxes.count();
    stride_ = std::uint64_t{n} + padding;
    device_.reserve(keys_, n * sizeof(std::uint32_t), "the keys of a sweep");
    device_.reserve(order_, n * sizeof(std::uint32_t), "the order of boxes");
    device_.reserve(columns_, stride_ * 6 * sizeof(float), "boxes as columns");
    device_.launch_items(keys_kernel_.args(boxes.on(device_), boxes.first(), n, choice.axis, keys_), n);
    sort_.sort(keys_, order_, n, 32, true);
    device_.launch_items(gather_kernel_.args(boxes.on(device_), boxes.first(), order_, choice.boxes,
                                             static_cast<std::uint32_t>(stride_), choice.axis, columns_),
                         stride_);
}

// Where each box's range ends; returns the turns of all of them. Waits.
std::uint64_t Sweep::find_ranges(std::uint32_t m) {
    const DeviceInfo& info = device_.info();
    const std::uint32_t wanted = std::clamp(m / 64, 1u, info.compute_units * (info.lanes > 1 ? 16u : 256u));
    per_run_ = std::clamp(m / wanted + 1, 1u, loop_budget(device_) / 66);  // two searches of 32 turns a box
    runs_ = (m - 1) / per_run_ + 1;
    device_.reserve(ends_, m * sizeof(std::uint32_t), "the ranges of a sweep");
    device_.reserve(before_, m * sizeof(std::uint64_t), "the turns of a sweep");
    device_.reserve(run_turns_, runs_ * sizeof(std::uint64_t), "the runs of a sweep");
    const std::size_t group = device_.group_size();
    device_.launch(ranges_kernel_.args(columns_, stride_, m, per_run_, runs_, ends_, before_, run_turns_),
                   (runs_ + group - 1) / group, group);
    std::vector<std::uint64_t> turns(runs_);
    device_.read(run_turns_, turns.data(), turns.size() * sizeof turns[0]);
    std::uint64_t total = 0;
    for (std::uint64_t& run : turns) total += std::exchange(run, total);
    device_.write(run_turns_, turns.data(), turns.size() * sizeof turns[0]);
    return total;
}

void Sweep::find(BoxInput& boxes, const FilterInput& filters, PairList& pairs, FindCounts& counts) {
    const std::uint32_t n = boxes.count();
    if (n < 2) {
        counts.invalid_boxes = n == 1;  // one box is looked at on the host
        return;
    }
    if (n > std::numeric_limits<std::uint32_t>::max() - padding)
        throw Error(ErrorCode::OutOfMemory, std::to_string(n) + " boxes are more than sweep can hold as columns");
    if (!keys_kernel_) {  // made last
        gather_kernel_ = device_.kernel("broad_phase/sweep", "sweep_gather");
        ranges_kernel_ = device_.kernel("broad_phase/sweep", "sweep_ranges");
        keys_kernel_ = device_.kernel("broad_phase/sweep", "sweep_keys");
    }
    const AxisChoice choice = axis_.choose(boxes);
    counts.invalid_boxes = choice.boxes < n;
    if (choice.boxes < 2) return;
    line_up(boxes, choice);
    const Pieces pieces = cut(device_, find_ranges(choice.boxes));

    Kernel& kernel = pairs_kernels_[filters.any() ? 1 : 0];
    if (!kernel) kernel = device_.kernel("broad_phase/sweep", "sweep_pairs", PairSink::defines(filters));
    kernel.args(columns_, stride_, choice.boxes, order_, ends_, before_, per_run_, runs_, run_turns_, pieces.turns);
    sink_.collect({{&kernel, 10, pieces.count, pieces.most_tasks}}, filters, n, pairs, counts);
}

}  // namespace

std::unique_ptr<BroadPhaseAlgorithm> make_sweep(Device* device, const BroadPhaseOptions& options) {
    return std::make_unique<Sweep>(*device, options);
}

}  // namespace clinch::detail
