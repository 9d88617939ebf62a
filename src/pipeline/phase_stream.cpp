#include "src/pipeline/phase_stream.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "src/device/crew.hpp"
#include "src/device/stopwatch.hpp"
#include "src/pipeline/phase_run.hpp"

namespace clinch::detail {
namespace {

BroadPhaseOptions unordered(BroadPhaseOptions options) {
    options.order = Order::Any;  // contacts are put in order, not pairs
    options.events = false;
    return options;
}

bool has(const std::vector<std::size_t>& devices, std::size_t device) {
    return std::find(devices.begin(), devices.end(), device) != devices.end();
}

// Rethrows the first that is not a mere consequence.
void rethrow_cause(const std::vector<std::exception_ptr>& thrown) {
    for (const std::exception_ptr& error : thrown) {
        if (error == nullptr) continue;
        try {
            std::rethrow_exception(error);
        } catch (const PhaseRun::Stopped&) {
            continue;
        }
    }
}

}  // namespace

PhaseStream::PhaseStream(Context& context, const BroadPhaseOptions& options, NarrowPhase::Impl& narrow)
    : context_(context.impl()),
      options_(unordered(options)),
      broad_(context, options_),
      narrow_(narrow, options.order == Order::Sorted),
      split_(context_, options_) {
    broad_.impl().alone = true;
}

// `alike`: devices that may work on the narrow phase, the primary one first.
PhaseRoles PhaseStream::roles_for(const AlgorithmRow& row, const std::vector<std::size_t>& alike,
                                  std::uint64_t bodies) {
    PhaseRoles roles{{}, alike, alike};
    if (!row.needs_device) return roles;
    // In the order in which they are given to the broad phase: those first that the other one has no use for.
    std::vector<std::size_t> able;
    const std::vector<std::size_t> crew = context_.crew();
    for (const std::size_t device : crew)
        if (!has(alike, device)) able.push_back(device);
    const std::size_t unlike = able.size();
    able.insert(able.end(), alike.begin(), alike.end());  // the boxes are on the first
    const auto units = static_cast<unsigned>(crew.size());
    std::size_t wanted = 1;
    if (units > 1) {
        if (!balance_ || balanced_ != units) balance_.emplace(units, unlike > 0 && unlike < units ? unlike : 0);
        balanced_ = units;
        balance_->scene_size(bodies);
        wanted = forced.broad_devices > 0 ? forced.broad_devices : balance_->broad_units();
    }
    const std::uint64_t worth = bodies / std::max<std::uint64_t>(1, context_.least_boxes_a_device);
    wanted = std::max<std::size_t>(1, std::min<std::uint64_t>({wanted, worth, Slabs::most}));
    if (!alike.empty() && units > 1) wanted = std::min<std::size_t>(wanted, units - 1);
    for (const std::size_t device : able)
        if (roles.broad.size() < wanted && runs_on(row, context_.infos[device])) roles.broad.push_back(device);
    const auto taken = [&](std::size_t device) { return has(roles.broad, device); };
    roles.narrow.erase(std::remove_if(roles.narrow.begin(), roles.narrow.end(), taken), roles.narrow.end());
    return roles;
}

// Pairs of a chunk that is not all beginning: that takes a few tenths of a millisecond.
std::size_t PhaseStream::least_chunk() const {
    constexpr double least_ms = 0.75, most_least = 4096.0;
    return static_cast<std::size_t>(
        std::clamp(least_ms / std::max(last_pair_ms_, 1e-9), double{NarrowStream::few_pairs}, most_least));
}

// Chunks enough for all devices to be done at about the same time.
std::size_t PhaseStream::chunk_pairs(std::uint64_t expected) const {
    constexpr std::uint64_t unknown = 16384, chunks_a_device = 2;
    if (forced.chunk_pairs > 0) return std::max<std::size_t>(forced.chunk_pairs, NarrowStream::few_pairs);
    if (expected == 0) return unknown;
    const std::uint64_t chunks = chunks_a_device * std::max<std::size_t>(1, context_.crew().size());
    // A few more than that share: else a few pairs too many would make one more chunk.
    const std::uint64_t share = expected / chunks + expected / (16 * chunks) + 1;
    return static_cast<std::size_t>(std::clamp<std::uint64_t>(share, least_chunk(), Slots::chunk_pairs));
}

// Whether boxes are searched where they are made: on the primary device, or the host.
bool PhaseStream::in_place(const PhaseRoles& roles) const {
    return roles.broad.empty() || (roles.broad.size() == 1 && roles.broad.front() == context_.primary());
}

void PhaseStream::find_pairs(const Step& step, Prepared& ready, const PhaseRoles& roles, PhaseRun& phases,
                             FindCounts& counts) {
    phases.take(phases.broad_place(), ready.more_pairs);
    if (ready.more_pairs.size() >= least_chunk()) phases.pause(phases.broad_place());
    if (in_place(roles)) return find_in_place(step, ready, phases, counts);
    const auto take = [&](std::size_t device, View<const Pair> pairs) { phases.take(device, pairs); };
    split_.stream(step.row, ready.boxes, ready.filters, {take, phases.piece()}, counts);
}

void PhaseStream::find_in_place(const Step& step, Prepared& ready, PhaseRun& phases, FindCounts& counts) {
    const Stopwatch watch;
    double taken_ms = 0.0;
    const PairList::Taker take = [&](View<const Pair> pairs) {
        const Stopwatch away;
        phases.take(phases.broad_place(), pairs);
        taken_ms += away.ms();
    };
    BroadPhase::Impl& broad = broad_.impl();
    broad.settle();
    broad.stream(step.row, ready.boxes, ready.filters, take, phases.piece(), false);
    in_place_ms_ = watch.ms() - taken_ms;
    const Report& found = broad.report;
    counts.box_tests = found.box_tests;
    counts.still = found.skipped.still;
    counts.boxes_inside = found.skipped.inside;
    counts.pairs_filtered = found.skipped.pairs_filtered;
    counts.static_pairs = found.skipped.static_pairs;
}

PhaseStream::Done PhaseStream::run(const Step& step) {
    const PhaseRoles roles = roles_for(step.row, narrow_.begin(step.scene), step.scene.row_count());
    std::optional<Prepared> ready;
    if (!in_place(roles)) {  // all that other devices have to do with it, before they are at work
        ready.emplace(step.prepare());
        split_.begin_stream(step.row, ready->boxes, roles.broad);
    }
    // After a step that failed nothing is expected.
    const std::uint64_t expected = std::exchange(last_pairs_, 0);
    PhaseRun phases(narrow_, roles, chunk_pairs(expected), !forced.no_help, memory_);
    double prepared_ms = 0.0;
    const auto find = [&](FindCounts& counts) {
        const Stopwatch watch;
        if (!ready) ready.emplace(step.prepare());
        prepared_ms = watch.ms();
        find_pairs(step, *ready, roles, phases, counts);
    };
    try {
        rethrow_cause(phases.run(find, expected >= NarrowStream::few_pairs));
        check_limit(phases.pairs(), options_);
        narrow_.finish();
    } catch (...) {
        narrow_.abandon();
        throw;
    }
    last_pairs_ = phases.pairs();
    last_pair_ms_ = phases.narrow_work_ms() / static_cast<double>(std::max<std::uint64_t>(1, phases.pairs()));
    learn(phases, roles);
    return Done{phases.counts(),
                phases.pairs(),
                ready->more_pairs.size(),
                phases.broad_ms() - prepared_ms,
                phases.narrow_ms(),
                phases.work(),
                roles.broad.size() > 1 ? split_.work() : std::vector<DeviceWork>()};
}

// What each phase would have taken on its devices alone.
void PhaseStream::learn(const PhaseRun& phases, const PhaseRoles& roles) {
    if (!balance_ || roles.broad.empty() || balanced_ < 2) return;
    if (forced.broad_devices > 0 || roles.broad.size() != balance_->broad_units()) return balance_->passed();
    double broad_ms = in_place(roles) ? in_place_ms_ : 0.0;
    if (!in_place(roles))
        for (const DeviceWork& work : split_.work()) broad_ms += work.ms;
    balance_->measured(
        {broad_ms / 1e3 / balance_->broad_units(), phases.narrow_work_ms() / 1e3 / balance_->narrow_units()});
}

}  // namespace clinch::detail
