#include "src/broad_phase/incremental.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <numeric>
#include <string>
#include <utility>

#include "src/device/stopwatch.hpp"

namespace clinch::detail {
namespace {

constexpr char module[] = "broad_phase/incremental";
constexpr std::uint32_t first_bit = 1, fresh_bit = 2;                 // FIRST and FRESH of the kernels
constexpr std::uint8_t leaves_list = 1, joins_list = 2, is_dead = 4;  // states of inc_test
// A fattened box is larger by this share of its longest side, on every side of it, and where it moves to by so many
// steps like its last, at most by that share. Larger: bodies leave it less often; smaller: fewer pairs to test.
constexpr float fat_share = 1.0f / 16, steps_ahead = 32.0f, most_ahead = 1.0f / 2;
// So large a part of the bodies may have become movers: then the grid is made anew.
constexpr std::uint32_t bodies_a_mover = 8;
constexpr std::uint32_t nodes_a_mover = 2, least_movers = 256;

// The cells of movers, as the struct of the same name in incremental.cl.
struct Cells {
    float origin[3];
    float scale, widest, reach;
    std::uint32_t mask;
};

BroadPhaseOptions inner_options(const BroadPhaseOptions& options) {
    BroadPhaseOptions inner;
    inner.order = Order::Any;
    inner.scratch_bytes = options.scratch_bytes;
    return inner;
}

template <class T>
std::size_t bytes_of(const std::vector<T>& values) {
    return values.capacity() * sizeof(T);
}

}  // namespace

Incremental::Incremental(Device& device, const BroadPhaseOptions& options)
    : device_(device),
      options_(options),
      search_options_(inner_options(options)),
      grid_(device, search_options_),
      sink_(device, search_options_),
      list_(device) {}

std::size_t Incremental::host_bytes() const noexcept {
    return bytes_of(mover_of_) + bytes_of(mover_bodies_) + bytes_of(leaver_of_) + bytes_of(leavers_) + bytes_of(live_) +
           bytes_of(free_) + bytes_of(states_) + bytes_of(ordered_) + bytes_of(marks_read_) + bytes_of(ordered_rows_) +
           bytes_of(added_) + bytes_of(removed_) + bytes_of(filter_rows_);
}

void Incremental::make_kernels() {
    if (query_old_) return;  // made last
    places_ = device_.kernel(module, "inc_places");
    run_ = device_.info().lanes > 1 ? 32 : 1;
    const std::string runs = "-DRUN=" + std::to_string(run_);
    apply_ = device_.kernel(module, "inc_apply", runs);
    move_ = device_.kernel(module, "inc_move");
    link_ = device_.kernel(module, "inc_link");
    test_ = device_.kernel(module, "inc_test", runs);
    begin_ = device_.kernel(module, "inc_begin");
    query_old_ = device_.kernel(module, "inc_query_old");
}

Incremental::FilterRow Incremental::filter_row(const FilterInput& filters, std::uint32_t body) const {
    return {filters.group(body), filters.mask(body), filters.can_move(body)};
}

// Pairs that one buffer holds; they are numbered in 32 bits.
std::uint64_t Incremental::most_pairs() const {
    return std::min<std::uint64_t>(device_.info().max_allocation / sizeof(Pair) / 9 * 8, none - 1);
}

bool Incremental::build(BoxInput& boxes, const FilterInput& filters, View<const Pair> pairs, bool sorted) {
    forget();
    make_kernels();
    const std::uint32_t n = boxes.count();
    if (pairs.size() > most_pairs_a_body * n || pairs.size() + std::size_t{2} * n > most_pairs()) return false;
    if (!grid_.bin(boxes)) return false;
    grid_.keep_entries_only();
    any_invalid_ = grid_.any_invalid();
    list_.begin(pairs, n, sorted);
    editing_ = false;
    filter_rows_.clear();
    if (filters.any()) {
        filter_rows_.reserve(n);
        for (std::uint32_t i = 0; i < n; ++i) filter_rows_.push_back(filter_row(filters, i));
    }
    ++filter_version_;
    device_.reserve(place_, std::size_t{n} * sizeof(std::uint32_t), "the places of bodies");
    device_.launch_items(places_.args(grid_.bins().order, n, place_), n);
    mover_of_.assign(n, none);
    mover_bodies_.clear();
    leaver_of_.clear();
    live_.clear();
    free_.clear();
    added_.clear();
    removed_.clear();
    frame_ = nodes_used_ = mover_room_ = 0;
    bodies_ = n;
    return true;
}

bool Incremental::update(BoxInput& boxes, const Changes& changes, const FilterInput& filters, PairList& pairs,
                         FindCounts& counts) {
    bool done = false;
    try {
        // Filters that come or go concern all.
        done = filters.any() != filter_rows_.empty() && step(boxes, ordered(changes), filters, counts);
        const Stopwatch watch;
        if (done) pairs.adopt(list_.map(), list_.size());
        counts.download_ms += watch.ms();
    } catch (...) {
        forget();
        throw;
    }
    editing_ = false;
    if (!done) forget();
    return done;
}

// Each body once, ascending.
Changes Incremental::ordered(const Changes& changes) {
    const View<const std::uint32_t> bodies = changes.bodies;
    const auto not_before = [](std::uint32_t a, std::uint32_t b) { return a >= b; };
    if (std::adjacent_find(bodies.begin(), bodies.end(), not_before) == bodies.end()) return changes;
    std::vector<std::uint32_t> numbers(bodies.size());
    std::iota(numbers.begin(), numbers.end(), 0u);
    std::sort(numbers.begin(), numbers.end(), [&](std::uint32_t i, std::uint32_t k) { return bodies[i] < bodies[k]; });
    numbers.erase(std::unique(numbers.begin(), numbers.end(),
                              [&](std::uint32_t i, std::uint32_t k) { return bodies[i] == bodies[k]; }),
                  numbers.end());
    ordered_.clear();
    ordered_rows_.clear();
    for (const std::uint32_t i : numbers) {
        ordered_.push_back(bodies[i]);
        if (changes.boxes != nullptr) ordered_rows_.push_back(changes.boxes[i]);
    }
    return {ordered_, changes.boxes == nullptr ? nullptr : ordered_rows_.data(), changes.any_filter};
}

bool Incremental::step(BoxInput& boxes, const Changes& changes, const FilterInput& filters, FindCounts& counts) {
    ++frame_;
    added_.clear();
    removed_.clear();
    find_leavers(boxes, changes, filters);
    if (mover_bodies_.size() > bodies_ / bodies_a_mover) return false;
    if (leavers_.empty())
        test(boxes);
    else if (!search(boxes, changes, filters, counts))
        return false;
    take_states();
    cancel();
    const std::uint64_t total = list_.size() + added_.size() - removed_.size();
    if (total > most_pairs()) return false;
    check_limit(total, options_);
    counts.invalid_boxes = any_invalid_;
    counts.boxes_inside += changes.bodies.size() - std::min(changes.bodies.size(), leavers_.size());
    list_.make_room(added_.size(), removed_.size());
    editing_ = true;
    list_.edit(added_, removed_);
    return true;
}

std::vector<Pair> Incremental::last_list() {
    std::vector<Pair> now = list_.copy();
    if (!editing_) return now;
    std::vector<Pair> rest, last;
    std::set_difference(now.begin(), now.end(), added_.begin(), added_.end(), std::back_inserter(rest));
    std::set_union(rest.begin(), rest.end(), removed_.begin(), removed_.end(), std::back_inserter(last));
    return last;
}

// Bodies whose filters are others than in the last step, and what they are now.
std::vector<Incremental::FilterChange> Incremental::filter_changes(const Changes& changes, const FilterInput& filters) {
    std::vector<FilterChange> found;
    if (filter_rows_.empty()) return found;
    const auto look_at = [&](std::uint32_t body) {
        const FilterRow row = filter_row(filters, body);
        if (filter_rows_[body] != row) found.push_back({body, row});
    };
    if (changes.any_filter)
        for (std::uint32_t i = 0; i < bodies_; ++i) look_at(i);
    else
        for (const std::uint32_t i : changes.bodies) look_at(i);
    return found;
}

// The body, whose box is number `row` of those that changed or none, is to be looked for afresh.
void Incremental::leave(std::uint32_t body, std::uint32_t row, std::uint32_t bits) {
    std::uint32_t& mover = mover_of_[body];
    if (mover == none) {
        mover = static_cast<std::uint32_t>(mover_bodies_.size());
        mover_bodies_.push_back(body);
        leaver_of_.push_back(none);
        bits |= first_bit;
        ++firsts_;
    }
    if (leaver_of_[mover] != none) {
        leavers_[leaver_of_[mover]].bits |= bits;
        return;
    }
    leaver_of_[mover] = static_cast<std::uint32_t>(leavers_.size());
    leavers_.push_back({body, mover, row, bits});
}

// Brings the movers up to date; gives the bodies that have left their fattened box, or must be looked for afresh.
void Incremental::find_leavers(BoxInput& boxes, const Changes& changes, const FilterInput& filters) {
    for (const Leaver& leaver : leavers_)
        if (leaver.mover < leaver_of_.size()) leaver_of_[leaver.mover] = none;
    leavers_.clear();
    firsts_ = 0;
    if (!changes.bodies.empty()) apply(boxes, changes);
    filter_changes_ = filter_changes(changes, filters);
    for (const FilterChange& change : filter_changes_) leave(change.first, none, fresh_bit);
}

void Incremental::apply(BoxInput& boxes, const Changes& changes) {
    const auto count = static_cast<std::uint32_t>(changes.bodies.size());
    const GridBins bins = grid_.bins();
    device_.reserve(changed_, count * sizeof(std::uint32_t), "changed bodies");
    device_.reserve(marks_, count * sizeof(std::uint32_t), "changed bodies");
    device_.reserve(rows_, changes.boxes == nullptr ? 0 : count * sizeof(Aabb), "changed boxes");
    device_.reserve(movers_, least_movers * sizeof(Mover), "movers");
    device_.reserve(fats_, least_movers * sizeof(Fat), "movers");
    device_.write(changed_, changes.bodies.data(), count * sizeof(std::uint32_t));
    if (changes.boxes != nullptr) device_.write(rows_, changes.boxes, count * sizeof(Aabb));
    apply_.args(changed_, count, rows_, changes.boxes == nullptr ? 1u : 0u, boxes.on(device_), boxes.first(),
                bins.columns, bins.stride, bodies_, place_, movers_, fats_, frame_, marks_);
    launch_runs(apply_, count);
    marks_read_.resize(count);
    device_.read(marks_, marks_read_.data(), count * sizeof(std::uint32_t));
    for (std::uint32_t i = 0; i < count; ++i) {
        if ((marks_read_[i] & 1) != 0) leave(changes.bodies[i], i, 0);
        any_invalid_ = any_invalid_ || marks_read_[i] > 1;
    }
}

// Looks for the bodies that have left, and tests all live pairs.
bool Incremental::search(BoxInput& boxes, const Changes& changes, const FilterInput& filters, FindCounts& counts) {
    SearchKernels& kernels = search_kernels_[filters.any() ? 1 : 0];
    if (!kernels.movers) {  // made last
        kernels.grid = device_.kernel(module, "inc_query", PairSink::defines(filters));
        kernels.movers = device_.kernel(module, "inc_query_movers", PairSink::defines(filters));
    }
    const auto count = static_cast<std::uint32_t>(leavers_.size());
    make_room_for_movers();
    device_.reserve(leavers_buffer_, count * sizeof(Leaver), "bodies that have left");
    device_.write(leavers_buffer_, leavers_.data(), count * sizeof(Leaver));
    if (firsts_ > 0) find_old_pairs(counts);
    for (const FilterChange& change : filter_changes_) filter_rows_[change.first] = change.second;
    if (!filter_changes_.empty()) ++filter_version_;
    move(boxes, changes);
    const GridBins bins = grid_.bins();
    kernels.grid.args(leavers_buffer_, fats_, bins.columns, bins.stride, bins.order, bins.start, bins.frame);
    kernels.movers.args(leavers_buffer_, movers_, fats_, static_cast<std::uint32_t>(mover_bodies_.size()), cells_,
                        heads_, nodes_, frame_);
    PairList found;
    sink_.collect({{&kernels.grid, 7, count}, {&kernels.movers, 8, count}}, {filters.columns, filter_version_},
                  filters.any() ? bodies_ : count, found, counts);
    if (live_.size() + found.size() > most_pairs() / 2) return false;  // buffers grow by half as much again
    make_room_for_pairs(found.size());
    test(boxes);
    begin_pairs(boxes, found.view());
    return true;
}

// Room for the movers there are now. When there is more of it, or no nodes are left for those that leave, those that
// were movers before this step are chained afresh.
void Incremental::make_room_for_movers() {
    const auto count = static_cast<std::uint32_t>(mover_bodies_.size()), before = count - firsts_;
    const auto leaving = static_cast<std::uint32_t>(leavers_.size());
    if (count > mover_room_) {
        mover_room_ = std::max(least_movers, std::min(2 * count, bodies_ / bodies_a_mover));
        grow<Mover>(movers_, before);
        grow<Fat>(fats_, before);
        chains_ = 1;
        while (chains_ < 2 * mover_room_) chains_ *= 2;
        device_.reserve(heads_, (std::size_t{chains_} + 1) * sizeof(std::uint32_t), "the cells of movers");
        device_.reserve(nodes_, (std::size_t{mover_room_} * nodes_a_mover + 1) * 2 * sizeof(std::uint32_t),
                        "the cells of movers");
        write_cells();
    } else if (nodes_used_ + leaving <= mover_room_ * nodes_a_mover) {
        return;
    }
    device_.clear(heads_, (std::size_t{chains_} + 1) * sizeof(std::uint32_t));
    if (before > 0) device_.launch_items(link_.args(fats_, before, cells_, heads_, nodes_), before);
    nodes_used_ = before;
}

// Room for all movers, of which `before` are kept.
template <class T>
void Incremental::grow(Buffer& buffer, std::uint32_t before) {
    std::vector<T> kept(before);
    device_.read(buffer, kept.data(), before * sizeof(T));
    device_.reserve(buffer, std::size_t{mover_room_} * sizeof(T), "movers");
    device_.write(buffer, kept.data(), before * sizeof(T));
}

// Cells fit the small boxes of the grid, fattened: what is larger goes elsewhere.
void Incremental::write_cells() {
    const GridFrame& frame = grid_.frame();
    Cells cells{};
    std::copy(frame.origin, frame.origin + 3, cells.origin);
    cells.widest = frame.widest * (1.0f + 2.0f * fat_share + most_ahead);
    // As in the grid: a box's max is at most its min plus its width, each rounded once.
    cells.reach = cells.widest * (1.0f + 0x1p-20f);
    cells.scale = 1.0f / std::max(2.0f * cells.reach, 1.0f / frame.scale[1]);
    cells.mask = chains_ - 1;
    device_.reserve(cells_, sizeof cells, "the cells of movers");
    device_.write(cells_, &cells, sizeof cells);
}

// What bodies that become movers overlapped until now leaves the list: what they still overlap joins it again.
void Incremental::find_old_pairs(FindCounts& counts) {
    const GridBins bins = grid_.bins();
    query_old_.args(leavers_buffer_, place_, bins.columns, bins.stride, bins.order, bins.start, bins.frame);
    const auto count = static_cast<std::uint32_t>(leavers_.size());
    PairList found;
    sink_.collect({{&query_old_, 7, count}}, {}, count, found, counts);
    for (const Pair& pair : found.view())
        if (pair.a != pair.b && (filter_rows_.empty() || filter_rows_[pair.a].allows(filter_rows_[pair.b])))
            removed_.push_back(pair);
}

void Incremental::move(BoxInput& boxes, const Changes& changes) {
    const GridBins bins = grid_.bins();
    const auto count = static_cast<std::uint32_t>(leavers_.size());
    move_.args(leavers_buffer_, count, rows_, changes.boxes == nullptr ? 1u : 0u, boxes.on(device_), boxes.first(),
               fat_share, steps_ahead, most_ahead, bodies_, frame_, bins.columns, bins.stride, place_, movers_, fats_,
               cells_, nodes_used_ + 1, heads_, nodes_);
    device_.launch_items(move_, count);
    nodes_used_ += count;
}

// Room for so many more live pairs. What has died was told to the host by the step in which it did.
void Incremental::make_room_for_pairs(std::size_t more) {
    const std::size_t wanted = live_.size() + more - std::min(more, free_.size());
    if (wanted * sizeof(LivePair) > live_buffer_.bytes()) {
        const std::size_t room = wanted + wanted / 2;
        device_.reserve(live_buffer_, room * sizeof(LivePair), "pairs of fattened boxes");
        device_.reserve(states_buffer_, room + sizeof(std::uint64_t), "pairs of fattened boxes");
        device_.write(live_buffer_, live_.data(), live_.size() * sizeof(LivePair));
    }
}

// Work-items that take a run each: few of them go together, so that all cores get some.
void Incremental::launch_runs(const Kernel& kernel, std::uint32_t count) {
    const std::size_t group = run_ > 1 ? 4 : 64, items = (count + run_ - 1) / run_;
    device_.launch(kernel, (items + group - 1) / group, group);
}

void Incremental::test(BoxInput& boxes) {
    if (live_.empty()) return;
    const auto count = static_cast<std::uint32_t>(live_.size());
    test_.args(live_buffer_, count, firsts_ > 0 ? 1u : 0u, place_, bodies_, boxes.on(device_), boxes.first(), movers_,
               frame_, states_buffer_);
    launch_runs(test_, count);
}

// These become live pairs, in free places as far as there are some.
void Incremental::begin_pairs(BoxInput& boxes, View<const Pair> found) {
    if (found.empty()) return;
    std::vector<Begun> begun;
    begun.reserve(found.size());
    for (const Pair& pair : found) {
        LivePair live{side(pair.a), side(pair.b)};
        if (live.p < bodies_) std::swap(live.p, live.q);
        auto place = static_cast<std::uint32_t>(live_.size());
        if (free_.empty()) {
            live_.push_back(live);
        } else {
            place = free_.back();
            free_.pop_back();
            live_[place] = live;
        }
        begun.push_back({place, live.p, live.q, 0});
    }
    const auto count = static_cast<std::uint32_t>(begun.size());
    device_.reserve(begun_, count * sizeof(Begun), "pairs of fattened boxes");
    device_.write(begun_, begun.data(), count * sizeof(Begun));
    begin_.args(begun_, count, bodies_, boxes.on(device_), boxes.first(), movers_, frame_, live_buffer_,
                states_buffer_);
    device_.launch_items(begin_, count);
}

// What the live pairs say joins and leaves the list; most say nothing.
void Incremental::take_states() {
    constexpr std::size_t word = sizeof(std::uint64_t);
    states_.resize((live_.size() + word - 1) / word * word);
    device_.read(states_buffer_, states_.data(), live_.size());
    std::fill(states_.begin() + static_cast<std::ptrdiff_t>(live_.size()), states_.end(), std::uint8_t{0});
    for (std::size_t first = 0; first < states_.size(); first += word) {
        std::uint64_t all = 0;
        std::memcpy(&all, states_.data() + first, word);
        if (all == 0) continue;
        for (std::size_t k = first; k < first + word; ++k)
            if (states_[k] != 0) take_state(static_cast<std::uint32_t>(k), states_[k]);
    }
}

void Incremental::take_state(std::uint32_t live, std::uint8_t state) {
    const std::uint32_t p = body(live_[live].p), q = body(live_[live].q);
    if ((state & leaves_list) != 0) removed_.push_back({std::min(p, q), std::max(p, q)});
    if ((state & joins_list) != 0) added_.push_back({std::min(p, q), std::max(p, q)});
    if ((state & is_dead) == 0) return;
    live_[live] = {none, none};
    free_.push_back(live);
}

// What both joins and leaves stays.
void Incremental::cancel() {
    std::sort(added_.begin(), added_.end());
    std::sort(removed_.begin(), removed_.end());
    removed_.erase(std::unique(removed_.begin(), removed_.end()), removed_.end());
    std::vector<Pair> both;
    std::set_intersection(added_.begin(), added_.end(), removed_.begin(), removed_.end(), std::back_inserter(both));
    if (both.empty()) return;
    for (std::vector<Pair>* const list : {&added_, &removed_})
        list->erase(std::set_difference(list->begin(), list->end(), both.begin(), both.end(), list->begin()),
                    list->end());
}

}  // namespace clinch::detail
