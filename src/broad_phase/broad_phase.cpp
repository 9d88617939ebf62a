#include "clinch/broad_phase.hpp"

#include <cmath>
#include <exception>
#include <limits>
#include <mutex>
#include <sstream>
#include <utility>

#include "clinch/interop/opencl.hpp"
#include "src/broad_phase/broad_phase_impl.hpp"
#include "src/device/failover.hpp"
#include "src/device/stopwatch.hpp"

namespace clinch {
namespace {

// Why a box is no box; empty if it is one.
std::string why_no_box(const Aabb& box) {
    constexpr char axis[] = "xyz";
    std::ostringstream why;
    for (int d = 0; d < 3; ++d) {
        const bool low = std::isfinite(box.min[d]);
        if (!low || !std::isfinite(box.max[d])) {
            why << (low ? "max " : "min ") << axis[d] << " is " << (low ? box.max[d] : box.min[d])
                << " and must be finite";
            break;
        }
        if (box.min[d] > box.max[d]) {
            why << "min " << axis[d] << " is " << box.min[d] << " and must not be greater than max " << axis[d] << ", "
                << box.max[d];
            break;
        }
    }
    return why.str();
}

std::vector<Rejection> rejected_boxes(View<const Aabb> boxes) {
    std::vector<Rejection> rejected;
    for (std::size_t i = 0; i < boxes.size(); ++i)
        if (std::string why = why_no_box(boxes[i]); !why.empty())
            rejected.push_back({static_cast<std::uint32_t>(i), std::move(why)});
    return rejected;
}

void check_count(std::uint64_t count) {
    if (count > std::numeric_limits<std::uint32_t>::max())
        throw Error(ErrorCode::LimitExceeded,
                    "there are " + std::to_string(count) + " boxes; at most 4294967295 are accepted");
}

// The boxes that the choice may look at: none where bodies that cannot move are named, which `bvh` keeps from call to
// call and no look at the boxes shows.
View<const Aabb> seen(View<const Aabb> boxes, const FilterColumns& filters) {
    return filters.motion == nullptr ? boxes : View<const Aabb>();
}

}  // namespace

void detail::check_options(const Context::Impl& context, const BroadPhaseOptions& options) {
    if (options.algorithm != "auto" && detail::algorithm_named(options.algorithm).needs_device && context.infos.empty())
        throw Error(ErrorCode::InvalidArgument,
                    "the algorithm '" + options.algorithm +
                        "' needs an OpenCL device, but the context was made for the host alone");
    if (options.events && options.order == Order::Any)
        throw Error(ErrorCode::InvalidArgument,
                    "events need sorted pairs (Order::Sorted), but any order (Order::Any) was asked for");
}

BroadPhase::Impl::Impl(Context& c, BroadPhaseOptions o) : context(c.impl()), options(std::move(o)) {
    detail::check_options(context, options);
}

const detail::AlgorithmRow& BroadPhase::Impl::choose(std::uint64_t count, View<const Aabb> boxes) const {
    if (options.algorithm != "auto") return detail::algorithm_named(options.algorithm);
    const std::uint64_t last_pairs = count == report.bodies ? report.pairs : 0;
    return detail::choose_algorithm(count, last_pairs,
                                    context.infos.empty() ? nullptr : &context.infos[context.primary()], boxes);
}

detail::Device& BroadPhase::Impl::device() const {
    return context.open(context.primary());
}

// Runs `search(counts)`, which puts pairs into `pairs` and returns whether it did, and writes the report.
template <class Search>
bool BroadPhase::Impl::measured(const char* algorithm, detail::BoxInput& boxes, const Search& search) {
    const detail::Stopwatch total;
    detail::FindCounts counts;
    try {
        if (!search(counts)) return false;
    } catch (...) {
        pairs.clear();
        throw;
    }
    report.ms.download = counts.download_ms;
    report.ms.broad = total.ms() - counts.download_ms - report.ms.upload;
    report.bodies = boxes.count();
    report.pairs = pairs.size();
    report.box_tests = counts.box_tests;
    report.algorithm = algorithm;
    report.skipped.inside = counts.boxes_inside;
    report.skipped.still = counts.still;
    report.skipped.pairs_filtered = counts.pairs_filtered;
    report.skipped.static_pairs = counts.static_pairs;
    any_invalid = counts.invalid_boxes;
    report.ms.total = total.ms();
    return true;
}

void BroadPhase::Impl::note_memory() {
    report.peak_device_bytes = 0;
    for (const auto& opened : context.devices)
        if (opened != nullptr) report.peak_device_bytes += opened->report().peak_bytes;
    most_host_bytes = std::max<std::uint64_t>(most_host_bytes, pairs.host_bytes() + events.host_bytes() +
                                                                   (incremental ? incremental->host_bytes() : 0) +
                                                                   (split ? split->host_bytes() : 0));
    report.peak_host_bytes = most_host_bytes;
}

View<const Pair> BroadPhase::Impl::find(const detail::AlgorithmRow& row, detail::BoxInput& boxes,
                                        const detail::FilterInput& filters, bool list_rejected) {
    pairs.clear();
    run(row, boxes, filters, list_rejected);
    listed(boxes.count());
    note_memory();
    return pairs.view();
}

// `pairs` is the list of `count` boxes.
void BroadPhase::Impl::listed(std::uint64_t count) {
    listed_boxes = count;
    if (!options.events) return;
    events.update(pairs.view());
    if (events_were_lost) report.warnings.emplace_back(events_lost);
    events_were_lost = false;
}

// The pairs from all devices that they are worth; false if one device is to find them.
bool BroadPhase::Impl::find_split(const detail::AlgorithmRow& row, detail::BoxInput& boxes,
                                  const detail::FilterInput& filters, detail::FindCounts& counts) {
    if (alone || context.infos.size() < 2) return false;
    if (context.crew().size() < 2) {
        split.reset();
        return false;
    }
    if (!split) split = std::make_unique<detail::BroadSplit>(context, options);
    if (!split->pays(row, boxes.count())) return false;
    if (pairs.streams()) {
        std::mutex one;  // at a time
        const auto take = [&](std::size_t, View<const Pair> found) {
            const std::lock_guard<std::mutex> lock(one);
            pairs.append(found.data(), found.size());
        };
        split->begin_stream(row, boxes, {});
        split->stream(row, boxes, filters, {take, pairs.piece()}, counts);
    } else {
        const bool done = split->find(row, boxes, filters, pairs, counts);
        report.warnings.insert(report.warnings.end(), split->warnings().begin(), split->warnings().end());
        if (!done) return false;
    }
    report.broad_split = split->work();
    split->forget_pairs();
    return true;
}

void BroadPhase::Impl::find_on_one(const detail::AlgorithmRow& row, detail::BoxInput& boxes,
                                   const detail::FilterInput& filters, detail::FindCounts& counts) {
    if (row.needs_device && !detail::runs_on(row, context.infos[context.primary()]))
        throw Error(ErrorCode::DeviceFailed, std::string("the algorithm '") + row.name + "' cannot run on '" +
                                                 context.infos[context.primary()].name +
                                                 "', whose driver has the quirk loops-end-early; brute can");
    const detail::Stopwatch upload;
    auto& algorithm = made[&row];
    if (!algorithm) algorithm = row.make(row.needs_device ? &device() : nullptr, options);
    if (row.needs_device) boxes.on(device());
    report.ms.upload = upload.ms();
    algorithm->find(boxes, filters, pairs, counts);
}

void BroadPhase::Impl::run(const detail::AlgorithmRow& row, detail::BoxInput& boxes, const detail::FilterInput& filters,
                           bool list_rejected) {
    listed_boxes = 0;
    leave_steps();
    report = Report{};
    measured(row.name, boxes, [&](detail::FindCounts& counts) {
        if (!find_split(row, boxes, filters, counts)) find_on_one(row, boxes, filters, counts);
        return true;
    });
    if (any_invalid && list_rejected) report.rejected = rejected_boxes(boxes.on_host());
}

void BroadPhase::Impl::stream(const detail::AlgorithmRow& row, detail::BoxInput& boxes,
                              const detail::FilterInput& filters, const detail::PairList::Taker& take,
                              std::size_t piece, bool list_rejected) {
    pairs.clear();
    pairs.stream_to(take, piece);
    run(row, boxes, filters, list_rejected);
    pairs.clear();  // `take` ends here
}

void BroadPhase::Impl::settle() {
    if (context.infos.empty() || made_on == context.primary()) return;
    const bool first = made_on == nowhere;
    made_on = context.primary();
    if (!first) drop_device();
}

void BroadPhase::Impl::drop_device() {
    pairs.clear();
    made.clear();
    listed_boxes = 0;
    try {
        leave_steps();
    } catch (const Error&) {  // the list before was on the device alone
        incremental.reset();
        events.start_afresh();
        events_were_lost = true;
    }
    staging = detail::Buffer();
}

bool BroadPhase::Impl::steps_pay(const detail::AlgorithmRow& row, std::uint64_t count, std::uint64_t changed) const {
    constexpr std::uint64_t fewest_boxes = 10000;
    return count >= fewest_boxes && count != steps_refused &&
           report.pairs <= detail::Incremental::most_pairs_a_body * count &&
           changed <= count / detail::Incremental::bodies_a_change && row.needs_device &&
           (options.algorithm == "auto" || options.algorithm == "grid") &&
           detail::runs_on(detail::algorithm_named("grid"), context.infos[context.primary()]);
}

bool BroadPhase::Impl::step(detail::BoxInput& boxes, const detail::Changes& changes,
                            const detail::FilterInput& filters) {
    if (!incremental) return false;
    pairs.clear();
    listed_boxes = 0;
    report = Report{};
    // When it throws, the next run() leaves the steps: what that takes may fail as well.
    if (!measured("incremental", boxes, [&](detail::FindCounts& counts) {
            return incremental->update(boxes, changes, filters, pairs, counts);
        })) {
        leave_steps();
        return false;
    }
    note_memory();
    report.skipped.unchanged = boxes.count() - std::min<std::uint64_t>(boxes.count(), changes.bodies.size());
    listed_boxes = boxes.count();
    if (options.events) events.change(incremental->added(), incremental->removed());
    return true;
}

// Gives back the memory of steps, which `pairs` does not map any more. The list before, which events begin from, may be
// there alone.
void BroadPhase::Impl::leave_steps() {
    if (!incremental) return;
    if (events.behind()) events.hold(incremental->last_list());
    incremental.reset();
}

View<const Pair> BroadPhase::Impl::find_to_step(const detail::AlgorithmRow& row, detail::BoxInput& boxes,
                                                const detail::FilterInput& filters, bool list_rejected) {
    pairs.clear();
    run(row, boxes, filters, list_rejected);
    begin_steps(boxes, filters);
    listed(boxes.count());
    return pairs.view();
}

void BroadPhase::Impl::begin_steps(detail::BoxInput& boxes, const detail::FilterInput& filters) {
    if (made_on != context.primary()) return;  // another device from now on: next time
    const detail::Stopwatch watch;
    const std::vector<Pair> list(pairs.view().begin(), pairs.view().end());
    pairs.clear();
    made.clear();  // their memory is needed now
    split.reset();
    incremental = std::make_unique<detail::Incremental>(device(), options);
    bool begun = false;
    try {
        begun = incremental->build(boxes, filters, list, options.order == Order::Sorted);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::OutOfMemory) throw;
    }
    if (begun) {
        pairs.adopt(incremental->map_list(), list.size());
    } else {
        incremental.reset();
        steps_refused = boxes.count();
        pairs.append(list);
    }
    note_memory();
    report.ms.broad += watch.ms();
    report.ms.total += watch.ms();
}

View<const Pair> BroadPhase::Impl::same_again() {
    report.box_tests = 0;
    report.ms = {};
    report.skipped = {};
    report.skipped.unchanged = listed_boxes;
    events.same_again();
    return pairs.view();
}

BroadPhase::BroadPhase(Context& context, BroadPhaseOptions options)
    : impl_(std::make_unique<Impl>(context, std::move(options))) {}
BroadPhase::~BroadPhase() = default;
BroadPhase::BroadPhase(BroadPhase&& other) noexcept = default;
BroadPhase& BroadPhase::operator=(BroadPhase&& other) noexcept = default;

// Runs `work`, which finds pairs of boxes of the host, on the device that is left.
template <class Work>
auto BroadPhase::Impl::in_any_case(const Work& work) -> decltype(work()) {
    std::vector<std::string> warnings;
    const auto result = detail::with_failover(
        context, warnings,
        [&] {
            settle();
            return work();
        },
        [] {});
    report.warnings.insert(report.warnings.begin(), warnings.begin(), warnings.end());
    return result;
}

View<const Pair> BroadPhase::find(View<const Aabb> boxes, const FilterColumns& filters) {
    check_count(boxes.size());
    return impl_->in_any_case([&] {
        detail::BoxInput input(boxes, impl_->staging);
        return impl_->find(impl_->choose(boxes.size(), seen(boxes, filters)), input, {filters, 0}, true);
    });
}

View<const Pair> BroadPhase::Impl::update(View<const Aabb> boxes, View<const std::uint32_t> changed,
                                          const FilterColumns& filters) {
    const detail::AlgorithmRow& row = choose(boxes.size());
    detail::BoxInput all(boxes, staging);
    if (listed_boxes == 0 || !steps_pay(row, boxes.size(), changed.size()))
        return find(choose(boxes.size(), seen(boxes, filters)), all, {filters, 0}, true);
    if (incremental) {
        std::vector<Aabb> rows(changed.size());
        for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = boxes[changed[i]];
        detail::BoxInput there(device(), staging.handle(), 0, static_cast<std::uint32_t>(boxes.size()));
        if (step(there, {changed, rows.data(), false}, {filters, 0})) {
            if (any_invalid) report.rejected = rejected_boxes(boxes);
            return pairs.view();
        }
    }
    return find_to_step(row, all, {filters, 0}, true);
}

View<const Pair> BroadPhase::update(View<const Aabb> boxes, View<const std::uint32_t> changed,
                                    const FilterColumns& filters) {
    check_count(boxes.size());
    for (const std::uint32_t i : changed)
        if (i >= boxes.size())
            throw Error(ErrorCode::InvalidArgument, "box " + std::to_string(i) +
                                                        " is said to have changed, but there are " +
                                                        std::to_string(boxes.size()) + " boxes");
    if (impl_->listed_boxes != boxes.size() || boxes.empty()) return find(boxes, filters);
    if (changed.empty()) return impl_->same_again();
    return impl_->in_any_case([&] { return impl_->update(boxes, changed, filters); });
}

std::uint64_t BroadPhase::stream(View<const Aabb> boxes, const std::function<void(View<const Pair>)>& take,
                                 const FilterColumns& filters) {
    check_count(boxes.size());
    if (!take) throw Error(ErrorCode::InvalidArgument, "there is no function to take the pairs of a stream");
    std::exception_ptr too_late;  // pairs that were handed over cannot be taken back
    const std::uint64_t count = impl_->in_any_case([&] {
        detail::BoxInput input(boxes, impl_->staging);
        bool handed_over = false;
        const auto hand_over = [&](View<const Pair> pairs) {
            handed_over = true;
            take(pairs);
        };
        try {
            impl_->stream(impl_->choose(boxes.size(), seen(boxes, filters)), input, {filters, 0}, hand_over,
                          impl_->options.stream_bytes / sizeof(Pair), true);
        } catch (...) {
            if (!handed_over) throw;
            too_late = detail::cause_of(std::current_exception());
            return std::uint64_t{0};
        }
        impl_->note_memory();
        return impl_->report.pairs;
    });
    if (too_late) std::rethrow_exception(too_late);
    return count;
}

std::uint64_t BroadPhase::count(View<const Aabb> boxes, const FilterColumns& filters) {
    check_count(boxes.size());
    return impl_->in_any_case([&] {
        detail::BoxInput input(boxes, impl_->staging);
        impl_->pairs.clear();
        impl_->pairs.count_only();
        impl_->run(impl_->choose(boxes.size(), seen(boxes, filters)), input, {filters, 0}, true);
        impl_->note_memory();
        return impl_->report.pairs;
    });
}

View<const Pair> BroadPhase::added() const noexcept {
    return impl_->events.added();
}
View<const Pair> BroadPhase::removed() const noexcept {
    return impl_->events.removed();
}

const Report& BroadPhase::report() const noexcept {
    return impl_->report;
}

View<const Pair> find_pairs(BroadPhase& broad_phase, cl_mem boxes, std::size_t count, std::size_t first,
                            const FilterColumns& filters) {
    check_count(count);
    BroadPhase::Impl& impl = broad_phase.impl();
    impl.settle();
    detail::Device& device = impl.device();
    const std::size_t bytes = device.bytes_of(boxes, "boxes");
    if (first > bytes / sizeof(Aabb) || count > bytes / sizeof(Aabb) - first)
        throw Error(ErrorCode::InvalidArgument, "the buffer of boxes has " + std::to_string(bytes) + " bytes; " +
                                                    std::to_string(count) + " boxes from box " + std::to_string(first) +
                                                    " on are 24 bytes each");
    detail::BoxInput input(device, boxes, first, static_cast<std::uint32_t>(count));
    return impl.find(impl.choose(count), input, {filters, 0}, true);
}

}  // namespace clinch
