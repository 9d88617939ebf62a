#include "src/broad_phase/slab_worker.hpp"

#include <utility>

#include "src/device/stopwatch.hpp"

namespace clinch::detail {
namespace {

// Those of the column that belong to members; null where there is no column.
template <class T>
const T* column_of(const T* column, const std::vector<std::uint32_t>& members, std::vector<T>& to) {
    if (column == nullptr) return nullptr;
    to.resize(members.size());
    for (std::size_t i = 0; i < members.size(); ++i) to[i] = column[members[i]];
    return to.data();
}

// Members of slab s, if `take` says so of the slabs that they reach into.
template <class Take>
std::vector<std::uint32_t> boxes_in(const SlabDeal& deal, std::size_t s, const Take& take) {
    std::vector<std::uint32_t> boxes;
    for (const std::uint32_t box : deal.members(s))
        if (take(deal.span(box))) boxes.push_back(box);
    return boxes;
}

}  // namespace

void SlabWorker::assign(std::size_t device) {
    if (device == device_) return;
    pairs_.clear();
    made_.clear();
    forget_room();
    staging_ = Buffer();
    names_ = Buffer();
    names_version_ = 0;
    device_ = device;
}

Aabb* SlabWorker::room_for(std::size_t members) noexcept {
    forget_room();
    if (members == 0) return nullptr;
    try {
        Device& device = context_.open(device_);
        device.reserve(staging_, members * sizeof(Aabb), "boxes");
        room_ = device.map_to_write(staging_, members * sizeof(Aabb));
        return room_.to<Aabb>();
    } catch (...) {
        no_room_ = std::current_exception();
        return nullptr;
    }
}

void SlabWorker::forget_room() noexcept {
    room_.release();
    no_room_ = nullptr;
}

// Boxes of members on the device, in their order: those in the room for them, if there is one.
const Buffer& SlabWorker::send(Device& device, const SlabTask& task, const std::vector<std::uint32_t>& members) {
    const bool is_there = room_.to<Aabb>() != nullptr && &members == &task.deal.members(slab_);
    Aabb* const rows = is_there ? nullptr : room_for(members.size());
    if (no_room_ != nullptr) std::rethrow_exception(std::exchange(no_room_, nullptr));
    for (std::size_t i = 0; rows != nullptr && i < members.size(); ++i) rows[i] = task.boxes[members[i]];
    device.written(std::move(room_));
    return staging_;
}

// Names boxes by their numbers among all.
void SlabWorker::name(Device& device, const SlabTask& task, BoxInput& input) {
    const std::vector<std::uint32_t>& members = task.deal.members(slab_);
    if (names_version_ != task.deal.version() || names_slab_ != slab_) {
        names_version_ = 0;
        device.reserve(names_, members.size() * sizeof members[0], "the numbers of boxes");
        device.write(names_, members.data(), members.size() * sizeof members[0]);
        names_version_ = task.deal.version();
        names_slab_ = slab_;
    }
    input.name(names_, names_version_, static_cast<std::uint32_t>(task.boxes.size()));
}

FilterInput SlabWorker::filters_of(const FilterInput& filters, const std::vector<std::uint32_t>& members) {
    return {{column_of(filters.columns.group, members, group_), column_of(filters.columns.mask, members, mask_),
             column_of(filters.columns.motion, members, motion_)},
            0};
}

// The pairs of the members into `pairs_`.
void SlabWorker::search(const SlabTask& task, const std::vector<std::uint32_t>& members) {
    if (members.empty()) return;
    Device& device = context_.open(device_);
    std::unique_ptr<BroadPhaseAlgorithm>& algorithm = made_[&task.row];
    if (!algorithm) algorithm = task.row.make(&device, options_);
    BoxInput input(device, send(device, task, members).handle(), 0, static_cast<std::uint32_t>(members.size()));
    if (&members == &task.deal.members(slab_) && !task.filters.any() && task.taker == nullptr)
        name(device, task, input);
    const Slabs& slabs = task.deal.slabs();
    input.want({static_cast<std::uint32_t>(slabs.axis), slabs.low(slab_), slabs.high(slab_)});
    const bool all = task.deal.count() == 1 && members.size() == task.boxes.size();
    algorithm->find(input, all ? task.filters : filters_of(task.filters, members), pairs_, counts_);
    // One box alone is none that an algorithm looks at: the host does.
    counts_.invalid_boxes = counts_.invalid_boxes || members.size() == 1;
}

// Pairs of two boxes that begin before the slab are counted there, too, unless the algorithm leaves them out.
void SlabWorker::count(const SlabTask& task, std::size_t s) {
    if (in_range_)
        search(task, task.deal.members(s));
    else
        search(task, boxes_in(task.deal, s, [s](SlabSpan span) { return span.first <= s && s <= span.last; }));
    found_ = counted_ = pairs_.size();
    if (s == 0 || in_range_) return;
    const FindCounts counts = counts_;
    pairs_.restart();
    search(task, boxes_in(task.deal, s, [s](SlabSpan span) { return span.first < s && s <= span.last; }));
    counted_ -= pairs_.size();
    counts_ = counts;
}

// Pairs piece by piece to where they go.
void SlabWorker::stream(const SlabTask& task, std::size_t s) {
    const std::vector<std::uint32_t>& members = task.deal.members(s);
    const bool all = members.size() == task.deal.boxes() && task.deal.count() == 1;
    found_ = 0;
    taken_ms_ = 0.0;
    const PairList::Taker take = [&](View<const Pair> pairs) {
        if (!all) {
            owned_.clear();
            for (const Pair& pair : pairs)
                if (const Pair named{members[pair.a], members[pair.b]};
                    in_range_ || task.deal.owner(named.a, named.b) == s)
                    owned_.push_back(named);
            pairs = {owned_.data(), owned_.size()};
        }
        found_ += pairs.size();
        const Stopwatch away;
        task.taker->take(device_, pairs);
        taken_ms_ += away.ms();
    };
    pairs_.stream_to(take, task.taker->piece);
    search(task, members);
    pairs_.clear();  // `take` ends here
}

void SlabWorker::find(const SlabTask& task, std::size_t s) {
    const Stopwatch watch;
    if (no_room_ != nullptr) std::rethrow_exception(std::exchange(no_room_, nullptr));
    Device& device = context_.open(device_);
    const double built_before = device.report().build_ms;
    pairs_.clear();
    counts_ = {};
    in_range_ = task.row.in_range;
    slab_ = s;
    if (task.counts_only) {
        pairs_.count_only();
        count(task, s);
    } else if (task.taker != nullptr) {
        stream(task, s);
    } else {
        if (task.keys) pairs_.accept_keys(*task.keys);
        search(task, task.deal.members(s));
        found_ = pairs_.size();
    }
    const double taken = task.taker != nullptr ? taken_ms_ : 0.0;
    seconds_ = (watch.ms() - taken - (device.report().build_ms - built_before)) / 1e3;
}

}  // namespace clinch::detail
