#include "src/narrow_phase/narrow_member.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "src/device/stopwatch.hpp"

namespace clinch::detail {

void NarrowMember::start_call() {
    worker_.start_call();
    for (const InHand& done : in_hand_) done.work->contacts().release();
    in_hand_.clear();
    set_aside_.clear();
    aside_.clear();
}

void NarrowMember::append_chunk(const NarrowCall& call, std::size_t first, std::size_t count, NarrowResult& result) {
    if (!worker_.began()) worker_.begin(call);
    first_.solve(call, first, count);
    const Stopwatch gather;
    result.append(call, first_.contacts());
    worker_.share().ms.gather += gather.ms();
}

std::pair<std::size_t, std::size_t> NarrowMember::put_chunk(const NarrowCall& call, std::atomic<std::size_t>& next,
                                                            NarrowResult& result) {
    if (!worker_.began()) worker_.begin(call);
    first_.solve(call, 0, call.pairs.size());
    const Stopwatch gather;
    const std::size_t count = first_.contacts().count(), first = next.fetch_add(count);
    result.write_at(call, first, 2 * (first + count), first_.contacts());
    worker_.share().ms.gather += gather.ms();
    return {first, count};
}

void NarrowMember::do_chunk(const NarrowCall& call, std::uint32_t chunk, std::size_t first, std::size_t count,
                            ContactPlaces& places, NarrowResult& result) {
    ChunkWork& work = free_work(call, places, result);
    const NarrowShare before = worker_.share();
    try {
        if (!worker_.began()) worker_.begin(call);
        work.solve(call, first, count);
    } catch (...) {
        worker_.share() = before;  // the chunk will be counted where it is done
        throw;
    }
    in_hand_.push_back({chunk, &work});
    places.tell(chunk, work.contacts().count());
    write_known(call, places, result);
}

// Memory that holds no chunk.
ChunkWork& NarrowMember::free_work(const NarrowCall& call, ContactPlaces& places, NarrowResult& result) {
    write_known(call, places, result);
    if (in_hand_.size() == 2) set_aside(call);
    if (in_hand_.empty() || in_hand_.front().work != &first_) return first_;
    if (!second_) second_ = std::make_unique<ChunkWork>(worker_);
    return *second_;
}

void NarrowMember::write_known(const NarrowCall& call, ContactPlaces& places, NarrowResult& result) {
    const Stopwatch gather;
    for (std::size_t i = 0; i < in_hand_.size();) {
        const std::optional<std::size_t> first = places.first_of(in_hand_[i].chunk);
        if (!first) {
            ++i;
            continue;
        }
        result.write_at(call, *first, places.expected(), in_hand_[i].work->contacts());
        in_hand_.erase(in_hand_.begin() + static_cast<std::ptrdiff_t>(i));
    }
    worker_.share().ms.gather += gather.ms();
}

// The older one.
void NarrowMember::set_aside(const NarrowCall& call) {
    const Stopwatch gather;
    const InHand done = in_hand_.front();
    ChunkContacts& chunk = done.work->contacts();
    set_aside_.push_back({done.chunk, aside_.size(call.only_pairs), chunk.count()});
    aside_.append(call, chunk);
    in_hand_.pop_front();
    worker_.share().ms.gather += gather.ms();
}

void NarrowMember::settle(const NarrowCall& call, ContactPlaces& places, NarrowResult& result) {
    write_known(call, places, result);
    while (!in_hand_.empty()) set_aside(call);
}

void NarrowMember::copy_set_aside(const NarrowCall& call, const ContactPlaces& places, NarrowResult& result) {
    for (const SetAside& part : set_aside_) {
        const std::size_t first = places.first_of(part.chunk).value();
        const auto copy = [&](const auto& from, auto& to) {
            const auto* const rows = from.view().data() + part.first;
            to.write_at(first, part.count, places.told(),
                        [&](auto* place) { std::copy(rows, rows + part.count, place); });
        };
        if (call.only_pairs)
            copy(aside_.touching, result.touching);
        else
            copy(aside_.contacts, result.contacts);
    }
    set_aside_.clear();
}

}  // namespace clinch::detail
