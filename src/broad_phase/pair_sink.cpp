#include "src/broad_phase/pair_sink.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "src/device/stopwatch.hpp"

namespace clinch::detail {
namespace {

// As the struct of the same name in pair_sink.clh.
struct SinkTail {
    std::uint32_t chunk, used;
    std::uint64_t filtered, unmoving, tests;
};
static_assert(sizeof(SinkTail) == 32, "kernels write this layout");

constexpr std::uint32_t no_chunk = 0xffffffffu;

// Room before the tails, in tails, for what the work-items share: chunks taken, and tasks taken of each launch.
std::size_t header_tails(std::size_t launches) {
    return ((1 + launches) * sizeof(std::uint32_t) + sizeof(SinkTail) - 1) / sizeof(SinkTail);
}

// Work-items of a launch: they take tasks one by one, so a few a core are enough.
std::size_t workers(const Device& device) {
    const DeviceInfo& info = device.info();
    return info.lanes > 1 ? info.compute_units * std::size_t{2} : info.compute_units * std::size_t{256};
}

struct Move {
    std::uint64_t from, to, count;
};

// Runs of pairs that bring those behind `total` into the gaps before it.
std::vector<Move> moves_into_gaps(std::vector<PartialChunk> tails, std::uint64_t chunks, std::uint64_t chunk_size) {
    std::sort(tails.begin(), tails.end(),
              [](const PartialChunk& a, const PartialChunk& b) { return a.chunk < b.chunk; });
    std::uint64_t total = chunks * chunk_size;
    for (const PartialChunk& tail : tails) total -= chunk_size - tail.used;

    std::vector<Move> moves;
    // Pairs behind `total`, chunk by chunk: those of a tail, or a whole chunk.
    std::uint64_t chunk = total / chunk_size, at = total;
    auto source = std::lower_bound(tails.begin(), tails.end(), chunk,
                                   [](const PartialChunk& tail, std::uint64_t c) { return tail.chunk < c; });
    const auto source_end = [&] {
        const bool is_tail = source != tails.end() && source->chunk == chunk;
        return chunk * chunk_size + (is_tail ? source->used : chunk_size);
    };
    for (const PartialChunk& tail : tails) {
        std::uint64_t to = std::uint64_t{tail.chunk} * chunk_size + tail.used;
        const std::uint64_t gap_end = std::min<std::uint64_t>(total, (std::uint64_t{tail.chunk} + 1) * chunk_size);
        while (to < gap_end) {
            while (at >= source_end()) {  // on to the next chunk
                if (source != tails.end() && source->chunk == chunk) ++source;
                at = ++chunk * chunk_size;
            }
            const std::uint64_t count = std::min(gap_end - to, source_end() - at);
            moves.push_back({at, to, count});
            at += count;
            to += count;
        }
    }
    return moves;
}

}  // namespace

PairSink::PairSink(Device& device, const BroadPhaseOptions& options)
    : device_(device), options_(options), filters_(device), sort_(device) {}

// Pairs that one buffer can hold.
std::uint64_t PairSink::most_pairs() const {
    return std::min<std::uint64_t>(device_.info().max_allocation / sizeof(Pair), 0xf0000000u);
}

// Work-groups that work on a part.
std::size_t PairSink::groups_of(const Part& part) const {
    const std::size_t group = device_.group_size();
    const std::uint32_t most = part.launch->most_tasks;
    const std::size_t items = most == 0 ? workers(device_) : (part.end - part.first - 1) / most + std::size_t{1};
    return (items + group - 1) / group;
}

std::size_t PairSink::workers_of(const std::vector<Part>& parts) const {
    std::size_t items = 0;
    for (const Part& part : parts) items += groups_of(part) * device_.group_size();
    return items;
}

// Room for `pairs` pairs that `all_workers` work-items put out, as far as `most` pairs go; with none they are counted.
void PairSink::plan(std::uint64_t pairs, std::uint64_t all_workers, std::uint64_t most) {
    chunk_size_ = 16;
    while (chunk_size_ < 4096 && std::uint64_t{chunk_size_} * all_workers * 16 < pairs) chunk_size_ *= 2;
    const std::uint64_t chunks =
        std::min(pairs / chunk_size_ + all_workers + 1, std::max<std::uint64_t>(most / chunk_size_, 1));
    device_.reserve(pairs_, chunks * chunk_size_ * sizeof(Pair), "pairs");
    const std::uint64_t room = most == 0 ? 0 : pairs_.bytes() / sizeof(Pair) / chunk_size_;
    capacity_ = static_cast<std::uint32_t>(std::min<std::uint64_t>(room, 0xfffffff0u));
}

// Enqueues all parts.
void PairSink::launch(const std::vector<Part>& parts, const cl_mem filters) {
    const std::size_t group = device_.group_size();
    std::size_t first_tail = header_tails(parts.size());
    for (std::uint32_t p = 0; p < parts.size(); ++p) {
        const SinkLaunch& launch = *parts[p].launch;
        const std::size_t groups = groups_of(parts[p]);
        launch.kernel->args_from(launch.own_parameters, pairs_, state_, static_cast<std::uint32_t>(first_tail), p,
                                 chunk_size_, capacity_, parts[p].first, parts[p].end,
                                 launch.most_tasks == 0 ? std::numeric_limits<std::uint32_t>::max() : launch.most_tasks,
                                 filters);
        device_.launch(*launch.kernel, groups, group);
        first_tail += groups * group;
    }
}

// What the work-items of the last launches left behind: `tails` of them behind a header as long as `header` tails.
PairSink::Outcome PairSink::read_outcome(std::size_t header, std::size_t tails) {
    std::vector<SinkTail> state(header + tails);
    device_.read(state_, state.data(), state.size() * sizeof state[0]);
    Outcome outcome;
    outcome.chunks = state[0].chunk;  // the first word
    outcome.pairs = outcome.chunks * chunk_size_;
    outcome.fits = outcome.chunks <= capacity_;
    partial_chunks_.clear();
    for (std::size_t t = header; t < state.size(); ++t) {
        const SinkTail& tail = state[t];
        outcome.counts.pairs_filtered += tail.filtered;
        outcome.counts.static_pairs += tail.unmoving;
        outcome.counts.box_tests += tail.tests;
        if (tail.chunk == no_chunk) continue;
        partial_chunks_.push_back({tail.chunk, tail.used});
        outcome.pairs -= chunk_size_ - tail.used;
    }
    return outcome;
}

PairSink::Outcome PairSink::run(const std::vector<Part>& parts, const FilterInput& filters, std::uint32_t bodies) {
    const std::size_t header = header_tails(parts.size()), tails = workers_of(parts);
    device_.reserve(state_, (header + tails) * sizeof(SinkTail), "the state of a sink");
    device_.clear(state_, header * sizeof(SinkTail));
    const cl_mem filter_rows = filters.any() ? filters_.on_device(filters, bodies).handle() : state_.handle();
    launch(parts, filter_rows);
    return read_outcome(header, tails);
}

void PairSink::close_gaps(const Outcome& outcome) {
    const std::vector<Move> moves = moves_into_gaps(partial_chunks_, outcome.chunks, chunk_size_);
    if (moves.empty()) return;
    if (!move_kernel_) move_kernel_ = device_.kernel("broad_phase/pair_sink", "sink_move");
    device_.reserve(moves_, moves.size() * sizeof moves[0], "the moves of a sink");
    device_.write(moves_, moves.data(), moves.size() * sizeof moves[0]);
    device_.launch_items(move_kernel_.args(pairs_, moves_, static_cast<std::uint32_t>(moves.size())), moves.size());
}

// Puts the pairs of an outcome behind those in `pairs`; `alone`: they are the only ones, and may stay on the device.
void PairSink::deliver(const Outcome& outcome, std::uint32_t bodies, bool alone, PairList& pairs, FindCounts& counts) {
    close_gaps(outcome);
    const KeyLayout* const keys = pairs.accepted_keys();
    if (alone && keys != nullptr && counts.named && options_.order == Order::Sorted &&
        PairSort::packs_on(device_.info())) {
        pairs.adopt(sort_.sort_to_keys(pairs_, outcome.pairs, *keys));
        return;
    }
    if (options_.order == Order::Sorted) sort_.sort(pairs_, outcome.pairs, bodies);
    const Stopwatch watch;
    Mapping mapping = device_.map(pairs_, outcome.pairs * sizeof(Pair));
    if (alone)
        pairs.adopt(std::move(mapping), outcome.pairs);
    else
        pairs.append(mapping.as<Pair>(), outcome.pairs);
    counts.download_ms += watch.ms();
}

void PairSink::add(const Outcome& outcome, FindCounts& counts) {
    counts.pairs_filtered += outcome.counts.pairs_filtered;
    counts.static_pairs += outcome.counts.static_pairs;
    counts.box_tests += outcome.counts.box_tests;
}

void PairSink::collect(const std::vector<SinkLaunch>& launches, const FilterInput& filters, std::uint32_t bodies,
                       PairList& pairs, FindCounts& counts) {
    std::vector<Part> parts;
    for (const SinkLaunch& launch : launches)
        if (launch.tasks > 0) parts.push_back({&launch, 0, launch.tasks});
    if (parts.empty()) return;
    const std::uint64_t all_workers = workers_of(parts);
    // A stream needs no more room than a piece of it.
    const std::uint64_t most = pairs.counts_only() ? 0 : std::min<std::uint64_t>(most_pairs(), pairs.piece());
    // A call that fails, perhaps for want of the room that the last one took, leaves no guess.
    const std::uint64_t expected = std::exchange(expected_, 0);
    plan(std::max<std::uint64_t>(expected + expected / 8, bodies), all_workers, most);
    if (pairs.streams() && expected > most && options_.max_pairs == std::numeric_limits<std::uint64_t>::max()) {
        collect_all_pieces(parts, expected, {filters, bodies, pairs, counts, most});
        return;
    }
    Outcome outcome = run(parts, filters, bodies);
    check_limit(outcome.pairs, options_);
    const std::uint64_t found = outcome.pairs;
    if (pairs.counts_only()) {
        add(outcome, counts);
        pairs.add_count(outcome.pairs);
        expected_ = found;
        return;
    }
    if (!outcome.fits) {
        // The room that the next call will ask for: fresh memory for many pairs takes longer than finding them.
        plan(outcome.pairs + outcome.pairs / 8, all_workers, most);
        if (outcome.pairs + chunk_size_ * all_workers <= most) outcome = run(parts, filters, bodies);
    }
    if (!outcome.fits) {
        collect_all_pieces(parts, outcome.pairs, {filters, bodies, pairs, counts, most});
        return;
    }
    add(outcome, counts);
    if (outcome.pairs > 0) deliver(outcome, bodies, true, pairs, counts);
    expected_ = found;
}

void PairSink::collect_all_pieces(const std::vector<Part>& parts, std::uint64_t expected, Collection to) {
    const std::uint64_t before = to.pairs.size();
    for (const Part& part : parts) collect_pieces(part, expected, to);
    expected_ = to.pairs.size() - before;
    if (options_.order == Order::Sorted) to.pairs.merge_runs(to.sorted_ends);
}

// The tasks of a part in pieces whose pairs fit, if there are `expected` pairs in it.
void PairSink::collect_pieces(const Part& part, std::uint64_t expected, Collection& to) {
    const std::uint64_t tasks = part.end - part.first;
    const std::uint64_t pieces = std::clamp<std::uint64_t>(expected / std::max<std::uint64_t>(to.most, 1) * 5 / 4 + 2,
                                                           std::min<std::uint64_t>(tasks, 2), tasks);
    for (std::uint64_t p = 0; p < pieces; ++p)
        collect_piece({part.launch, part.first + static_cast<std::uint32_t>(tasks * p / pieces),
                       part.first + static_cast<std::uint32_t>(tasks * (p + 1) / pieces)},
                      to);
}

// Takes the pairs of some tasks to the host; cuts the tasks further when the pairs do not fit.
void PairSink::collect_piece(const Part& part, Collection& to) {
    Outcome outcome = run({part}, to.filters, to.bodies);
    if (!outcome.fits && part.end - part.first > 1) {
        collect_pieces(part, outcome.pairs, to);
        return;
    }
    if (!outcome.fits) {  // one task: it needs what it needs
        plan(outcome.pairs, workers_of({part}), most_pairs());
        outcome = run({part}, to.filters, to.bodies);
        if (!outcome.fits)
            throw Error(ErrorCode::OutOfMemory, std::to_string(outcome.pairs) +
                                                    " pairs of one task do not fit in one buffer of '" +
                                                    device_.info().name + "'");
    }
    add(outcome, to.counts);
    if (outcome.pairs == 0) return;
    deliver(outcome, to.bodies, false, to.pairs, to.counts);
    to.sorted_ends.push_back(static_cast<std::size_t>(to.pairs.size()));
}

}  // namespace clinch::detail
