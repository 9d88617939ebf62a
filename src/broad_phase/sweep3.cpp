// sweep3: the bounds of three axes sorted, pairs that overlap on all of them. See cl/broad_phase/sweep3.cl.
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "src/broad_phase/algorithm.hpp"
#include "src/device/quirks.hpp"
#include "src/device/stopwatch.hpp"
#include "src/primitives/bits.hpp"
#include "src/primitives/radix_sort.hpp"
#include "src/primitives/scan.hpp"

namespace clinch::detail {
namespace {

// Keys and payload twice, marks, places and pairs.
constexpr std::size_t bytes_an_overlap = 2 * (8 + 4) + 4 + 4 + 8;
// Smaller scratch memory than this is taken as this: a batch costs some forty launches.
constexpr std::size_t least_scratch = std::size_t{1} << 20;

// Work-items that each own a run of consecutive entries.
struct Runs {
    std::uint32_t length, count;
};

class Sweep3 : public BroadPhaseAlgorithm {
public:
    Sweep3(Device& device, const BroadPhaseOptions& options)
        : device_(device),
          options_(options),
          scan_(device),
          sort_bounds_(device),
          sort_pairs_(device, RadixSort::Key::Bits64),
          filters_(device) {}

    void find(BoxInput& boxes, const FilterInput& filters, PairList& pairs, FindCounts& counts) override;

private:
    // Pairs whose lower body number is in [first, end), and the overlaps listed for them.
    struct Batch {
        std::uint32_t first, end;
        std::uint32_t listed;
    };
    struct Axis {
        Buffer order, last;
        std::uint64_t overlaps = 0;  // of all bodies
    };

    void load_kernels();
    void sort_axis(BoxInput& boxes, std::uint32_t axis);
    void rank_axes(BoxInput& boxes);
    Runs runs_of(std::uint32_t entries) const;
    void launch_runs(const Kernel& kernel, const Runs& runs);
    std::uint64_t open_batch(const Axis& axis, std::uint32_t first, std::uint32_t end);
    void launch_overlaps(Kernel& kernel, const Axis& axis, std::uint32_t first, std::uint32_t end, std::uint64_t count);
    std::uint64_t most_listed() const;
    Batch list_overlaps(std::uint32_t first, std::uint32_t& rows);
    std::uint64_t mark_common(const Batch& batch);
    std::uint32_t keep_allowed(const Batch& batch, const FilterInput& filters, FindCounts& counts);
    Mapping pairs_of(const Batch& batch, std::uint32_t kept, FindCounts& counts);

    Device& device_;
    const BroadPhaseOptions& options_;
    Scan scan_;
    RadixSort sort_bounds_, sort_pairs_;
    FilterMirror filters_;
    Kernel bounds_kernel_, starts_kernel_, ranks_kernel_, members_kernel_, lists_kernel_, count_kernel_, fill_kernel_,
        rows_kernel_, mark_kernel_, keep_kernels_[2], pairs_kernel_;
    std::array<Axis, 3> axes_;  // the one with the fewest overlaps first
    Buffer bounds_, bound_order_, starts_, ranks_;
    Buffer in_t_, in_s_, t_, s_, t_list_, s_list_, before_, run_counts_;
    Buffer keys_, payload_, rows_, marks_, places_, drops_, pairs_;
    std::uint32_t n_ = 0, boxes_ = 0;  // rows, and those that are boxes
    Runs runs_{};                      // over the ranks
};

void Sweep3::load_kernels() {
    if (bounds_kernel_) return;  // made last
    const std::string module = "broad_phase/sweep3";
    starts_kernel_ = device_.kernel(module, "sweep3_starts");
    ranks_kernel_ = device_.kernel(module, "sweep3_ranks");
    members_kernel_ = device_.kernel(module, "sweep3_members");
    lists_kernel_ = device_.kernel(module, "sweep3_lists");
    count_kernel_ = device_.kernel(module, "sweep3_count");
    fill_kernel_ = device_.kernel(module, "sweep3_fill");
    rows_kernel_ = device_.kernel(module, "sweep3_rows");
    mark_kernel_ = device_.kernel(module, "sweep3_mark");
    pairs_kernel_ = device_.kernel(module, "sweep3_pairs");
    bounds_kernel_ = device_.kernel(module, "sweep3_bounds");
}

// Ranks all bodies on one axis.
void Sweep3::sort_axis(BoxInput& boxes, std::uint32_t d) {
    Axis& axis = axes_[d];
    const std::size_t bytes = std::size_t{n_} * sizeof(std::uint32_t);
    device_.reserve(axis.order, bytes, "the ranks of a sweep");
    device_.reserve(axis.last, bytes, "the ranks of a sweep");
    device_.launch_items(bounds_kernel_.args(boxes.on(device_), boxes.first(), n_, d, bounds_), n_);
    sort_bounds_.sort(bounds_, bound_order_, 2 * n_, 32, true);
    device_.launch_items(starts_kernel_.args(bounds_, bound_order_, n_, starts_), std::size_t{2} * n_);
    scan_.exclusive(starts_, 2 * n_, ranks_);
    device_.launch_items(ranks_kernel_.args(bound_order_, starts_, ranks_, n_, axis.order, axis.last),
                         std::size_t{2} * n_);
}

// Ranks all bodies on all axes, and puts the axis with the fewest overlaps first. Waits.
void Sweep3::rank_axes(BoxInput& boxes) {
    const std::size_t bytes = std::size_t{n_} * sizeof(std::uint32_t);
    for (Buffer* buffer : {&bounds_, &bound_order_, &starts_, &ranks_})
        device_.reserve(*buffer, 2 * bytes, "the bounds of a sweep");
    for (std::uint32_t d = 0; d < 3; ++d) sort_axis(boxes, d);
    boxes_ = scan_.total();
    if (boxes_ < 2) return;
    for (Buffer* buffer : {&in_t_, &in_s_, &t_, &s_})
        device_.reserve(*buffer, bytes + sizeof(std::uint32_t), "the bodies of a batch");
    for (Buffer* buffer : {&t_list_, &s_list_}) device_.reserve(*buffer, bytes, "the bodies of a batch");
    device_.reserve(before_, 2 * bytes, "the overlaps of bodies");
    runs_ = runs_of(boxes_);
    for (Axis& axis : axes_) axis.overlaps = open_batch(axis, 0, n_);
    std::iter_swap(axes_.begin(), std::min_element(axes_.begin(), axes_.end(), [](const Axis& a, const Axis& b) {
                       return a.overlaps < b.overlaps;
                   }));
}

Runs Sweep3::runs_of(std::uint32_t entries) const {
    const DeviceInfo& info = device_.info();
    const std::uint32_t wanted = std::clamp(entries / 64, 1u, info.compute_units * (info.lanes > 1 ? 4u : 64u));
    const std::uint32_t length = std::min(entries / wanted + 1, most_loop_iterations(info) / 4);
    return {length, entries == 0 ? 0 : (entries - 1) / length + 1};
}

void Sweep3::launch_runs(const Kernel& kernel, const Runs& runs) {
    const std::size_t group = device_.group_size();
    device_.launch(kernel, (runs.count + group - 1) / group, group);
}

// Makes ready to go through the overlaps of an axis that belong to a batch; returns how many there are. Waits.
std::uint64_t Sweep3::open_batch(const Axis& axis, std::uint32_t first, std::uint32_t end) {
    device_.launch_items(members_kernel_.args(axis.order, boxes_, first, end, in_t_, in_s_), std::size_t{boxes_} + 1);
    scan_.exclusive(in_t_, boxes_ + 1, t_);
    scan_.exclusive(in_s_, boxes_ + 1, s_);
    device_.launch_items(lists_kernel_.args(axis.order, boxes_, first, end, t_, s_, t_list_, s_list_), boxes_);
    device_.reserve(run_counts_, runs_.count * sizeof(std::uint64_t), "the overlaps of bodies");
    launch_runs(count_kernel_.args(axis.order, axis.last, boxes_, first, end, t_, s_, runs_.length, runs_.count,
                                   before_, run_counts_),
                runs_);
    std::vector<std::uint64_t> counts(runs_.count);
    device_.read(run_counts_, counts.data(), counts.size() * sizeof counts[0]);
    std::uint64_t total = 0;
    for (std::uint64_t& count : counts) total += std::exchange(count, total);
    device_.write(run_counts_, counts.data(), counts.size() * sizeof counts[0]);
    return total;
}

// Goes through the overlaps that open_batch() counted; parameters of the kernel from number 16 on are set already.
void Sweep3::launch_overlaps(Kernel& kernel, const Axis& axis, std::uint32_t first, std::uint32_t end,
                             std::uint64_t count) {
    // Each is sought in three searches of 32 turns at most; where loops end early the 16 work-items of a vector
    // may have to wait for each other in all of them.
    const std::uint32_t piece = std::min(256u, most_loop_iterations(device_.info()) / (16 * 3 * 33));
    kernel.args(axis.order, axis.last, t_, s_, t_list_, s_list_, before_, run_counts_, boxes_, first, end, runs_.length,
                runs_.count, count, piece, bits_of(n_ - 1));
    device_.launch_items(kernel, (count + piece - 1) / piece);
}

// Overlaps that one batch may list.
std::uint64_t Sweep3::most_listed() const {
    const std::uint64_t wanted = std::max(options_.scratch_bytes, least_scratch) / bytes_an_overlap;
    return std::min({wanted, device_.info().max_allocation / sizeof(std::uint64_t), std::uint64_t{1} << 31});
}

// The sorted keys of a batch from body `first` on, of the axis with the fewest overlaps. `rows`, the bodies it
// is tried with, becomes a guess for the next one. A body's overlaps are never parted, however many they are. Waits.
Sweep3::Batch Sweep3::list_overlaps(std::uint32_t first, std::uint32_t& rows) {
    const std::uint64_t most = most_listed();
    const auto fitting = [&](std::uint64_t tried, std::uint64_t count) {
        const double share = 0.75 * static_cast<double>(most) / static_cast<double>(std::max<std::uint64_t>(count, 1));
        return static_cast<std::uint32_t>(std::clamp(static_cast<double>(tried) * share, 1.0, 4.0 * rows));
    };
    rows = std::min(rows, n_ - first);
    std::uint64_t count = open_batch(axes_[0], first, first + rows);
    while (count > most && rows > 1) {
        rows = fitting(rows, count);
        count = open_batch(axes_[0], first, first + rows);
    }
    const Batch batch{first, first + rows, static_cast<std::uint32_t>(count)};
    device_.reserve(keys_, count * sizeof(std::uint64_t), "the overlaps of an axis");
    device_.reserve(payload_, count * sizeof(std::uint32_t), "the overlaps of an axis");
    fill_kernel_.args_from(16, keys_);
    launch_overlaps(fill_kernel_, axes_[0], batch.first, batch.end, count);
    sort_pairs_.sort(keys_, payload_, batch.listed, bits_of(n_ - 1) + bits_of(rows - 1), true);
    rows = static_cast<std::uint32_t>(std::min<std::uint64_t>(fitting(rows, count), n_));
    return batch;
}

// Marks the listed overlaps that the two other axes have too; returns how many overlaps those had. Waits.
std::uint64_t Sweep3::mark_common(const Batch& batch) {
    device_.reserve(marks_, batch.listed * sizeof(std::uint32_t), "the marks of overlaps");
    device_.clear(marks_, batch.listed * sizeof(std::uint32_t));
    const std::uint32_t rows = batch.end - batch.first;
    device_.reserve(rows_, (std::size_t{rows} + 1) * sizeof(std::uint32_t), "the rows of a batch");
    device_.launch_items(rows_kernel_.args(keys_, batch.listed, rows, bits_of(n_ - 1), rows_), std::size_t{rows} + 1);
    std::uint64_t overlaps = 0;
    for (std::size_t d = 1; d < 3; ++d) {
        const std::uint64_t count = open_batch(axes_[d], batch.first, batch.end);
        mark_kernel_.args_from(16, keys_, rows_, marks_);
        launch_overlaps(mark_kernel_, axes_[d], batch.first, batch.end, count);
        overlaps += count;
    }
    return overlaps;
}

// Which marked overlaps pass the filters; returns how many. Waits.
std::uint32_t Sweep3::keep_allowed(const Batch& batch, const FilterInput& filters, FindCounts& counts) {
    Kernel& kernel = keep_kernels_[filters.any() ? 1 : 0];
    if (!kernel) kernel = device_.kernel("broad_phase/sweep3", "sweep3_keep", filters.any() ? "-DFILTERS=1" : "");
    const Runs runs = runs_of(batch.listed);
    std::vector<std::array<std::uint64_t, 2>> drops(runs.count);
    device_.reserve(drops_, drops.size() * sizeof drops[0], "the counts of filters");
    device_.reserve(places_, batch.listed * sizeof(std::uint32_t), "the places of pairs");
    launch_runs(kernel.args(keys_, batch.listed, batch.first, bits_of(n_ - 1), runs.length, runs.count,
                            filters.any() ? filters_.on_device(filters, n_) : marks_, marks_, drops_),
                runs);
    scan_.exclusive(marks_, batch.listed, places_);
    if (filters.any()) device_.read(drops_, drops.data(), drops.size() * sizeof drops[0]);
    for (const auto& drop : drops) {
        counts.pairs_filtered += drop[0];
        counts.static_pairs += drop[1];
    }
    return scan_.total();
}

// The `kept` pairs of a batch, in order, readable until the next one.
Mapping Sweep3::pairs_of(const Batch& batch, std::uint32_t kept, FindCounts& counts) {
    device_.reserve(pairs_, kept * sizeof(Pair), "pairs");
    device_.launch_items(pairs_kernel_.args(keys_, batch.listed, batch.first, bits_of(n_ - 1), marks_, places_, pairs_),
                         batch.listed);
    const Stopwatch watch;
    Mapping mapping = device_.map(pairs_, kept * sizeof(Pair));
    counts.download_ms += watch.ms();
    return mapping;
}

void Sweep3::find(BoxInput& boxes, const FilterInput& filters, PairList& pairs, FindCounts& counts) {
    n_ = boxes.count();
    if (n_ < 2) {
        counts.invalid_boxes = n_ == 1;  // one box is looked at on the host
        return;
    }
    if (n_ >= std::uint32_t{1} << 31)
        throw Error(ErrorCode::OutOfMemory,
                    "the bounds of " + std::to_string(n_) + " boxes are more than sweep3 ranks");
    load_kernels();
    rank_axes(boxes);
    counts.invalid_boxes = boxes_ < n_;
    if (boxes_ < 2) return;

    std::uint64_t total = 0;
    std::uint32_t rows = n_;  // of a batch; cut down where they have too many overlaps
    for (std::uint32_t first = 0; first < n_;) {
        if (options_.progress) options_.progress(static_cast<double>(first) / static_cast<double>(n_));
        const Batch batch = list_overlaps(first, rows);
        first = batch.end;
        counts.box_tests += batch.listed;
        if (batch.listed == 0) continue;
        counts.box_tests += mark_common(batch);
        const std::uint32_t kept = keep_allowed(batch, filters, counts);
        total += kept;
        if (pairs.counts_only()) pairs.add_count(kept);
        if (kept == 0 || pairs.counts_only() || total > options_.max_pairs) continue;  // counts on, for the error below
        Mapping mapping = pairs_of(batch, kept, counts);
        if (batch.end - batch.first == n_)
            pairs.adopt(std::move(mapping), kept);
        else
            pairs.append(mapping.as<Pair>(), kept);
    }
    check_limit(total, options_);
}

}  // namespace

std::unique_ptr<BroadPhaseAlgorithm> make_sweep3(Device* device, const BroadPhaseOptions& options) {
    return std::make_unique<Sweep3>(*device, options);
}

}  // namespace clinch::detail
