#include "src/broad_phase/kept_list.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace clinch::detail {
namespace {

// Pairs shift by at most so many places in one go: a sixteenth of the list is copied away then.
constexpr std::uint32_t most_halo = 1024, least_halo = 16;
constexpr std::uint32_t halos_a_block = 32;

}  // namespace

void KeptList::begin(View<const Pair> pairs, std::uint32_t bodies, bool sorted) {
    if (!edit_) {  // made last
        locate_ = device_.kernel("broad_phase/kept_list", "list_locate");
        save_ = device_.kernel("broad_phase/kept_list", "list_save");
        edit_ = device_.kernel("broad_phase/kept_list", "list_edit");
    }
    size_ = 0;
    std::vector<Pair>().swap(on_host_);
    device_.reserve(pairs_, (pairs.size() + pairs.size() / 16 + most_halo) * sizeof(Pair), "pairs");
    device_.write(pairs_, pairs.data(), pairs.size() * sizeof(Pair));
    size_ = static_cast<std::uint32_t>(pairs.size());
    if (!sorted) PairSort(device_).sort(pairs_, size_, bodies);
}

// Old and new need not fit side by side: the pairs wait on the host.
void KeptList::reserve_pairs(std::size_t pairs) {
    if (pairs_.bytes() >= pairs * sizeof(Pair)) return;
    std::vector<Pair> kept(size_);
    device_.read(pairs_, kept.data(), kept.size() * sizeof(Pair));
    try {
        device_.reserve(pairs_, (pairs + pairs / 16) * sizeof(Pair), "pairs");
        device_.write(pairs_, kept.data(), kept.size() * sizeof(Pair));
    } catch (...) {
        on_host_ = std::move(kept);
        throw;
    }
}

std::vector<Pair> KeptList::copy() {
    if (!on_host_.empty()) return on_host_;
    std::vector<Pair> pairs(size_);
    device_.read(pairs_, pairs.data(), pairs.size() * sizeof(Pair));
    return pairs;
}

void KeptList::make_room(std::size_t added, std::size_t removed) {
    const std::size_t edits = added + removed;
    if (edits == 0) return;
    device_.reserve(edits_, edits * sizeof(Edit), "the edits of a list");
    device_.reserve(at_, edits * sizeof(std::uint32_t), "the edits of a list");
    reserve_pairs(size_ + added);
    // Passes differ in their shifts and the list's size.
    std::size_t saved = 0;
    for (std::uint32_t shift = least_halo; shift <= most_halo; shift *= 2) {
        const Shape shape = shape_for(shift);
        saved = std::max(saved, (std::size_t{shape.blocks} + added / shape.block + 1) * shape.halo);
    }
    device_.reserve(saved_, saved * 2 * sizeof(Pair), "the edges of a list's blocks");
}

// Blocks enough for all cores, whose edges are a small part of them.
KeptList::Shape KeptList::shape_for(std::uint32_t most_shift) const {
    const DeviceInfo& info = device_.info();
    Shape s{};
    s.halo = least_halo;
    while (s.halo < most_shift) s.halo *= 2;
    const std::uint32_t items = info.compute_units * (info.lanes > 1 ? 16 : 1024);
    s.block = std::max(s.halo * halos_a_block, size_ / items);
    s.blocks = size_ / s.block + (size_ % s.block != 0 || size_ == 0 ? 1 : 0);
    return s;
}

void KeptList::edit(View<const Pair> added, View<const Pair> removed) {
    std::vector<Edit> edits;
    edits.reserve(added.size() + removed.size());
    std::int32_t shift = 0;
    std::uint32_t most_shift = 0;
    const Pair *to_add = added.begin(), *to_take = removed.begin();
    while (to_add != added.end() || to_take != removed.end()) {
        const bool adds = to_take == removed.end() || (to_add != added.end() && *to_add < *to_take);
        const Pair& pair = adds ? *to_add++ : *to_take++;
        edits.push_back({pair.a, pair.b, adds ? 1u : 0u, shift});
        shift += adds ? 1 : -1;
        most_shift = std::max(most_shift, static_cast<std::uint32_t>(std::abs(shift)));
        if (most_shift < most_halo) continue;
        run(edits, shift, most_shift);
        edits.clear();
        shift = 0;
        most_shift = 0;
    }
    if (!edits.empty()) run(edits, shift, most_shift);
}

void KeptList::run(View<const Edit> edits, std::int32_t shift_at_end, std::uint32_t most_shift) {
    const Shape s = shape_for(most_shift);
    const auto count = static_cast<std::uint32_t>(edits.size());
    device_.write(edits_, edits.data(), edits.size() * sizeof(Edit));
    device_.launch_items(locate_.args(pairs_, size_, edits_, count, at_), count);
    const std::size_t group = device_.group_size(), groups = (s.blocks + group - 1) / group;
    device_.launch(save_.args(pairs_, size_, s.block, s.halo, s.blocks, saved_), groups, group);
    edit_.args(pairs_, size_, s.block, s.halo, s.blocks, edits_, at_, count, shift_at_end, saved_);
    device_.launch(edit_, groups, group);  // nothing before this has changed the list
    size_ = static_cast<std::uint32_t>(static_cast<std::int64_t>(size_) + shift_at_end);
}

}  // namespace clinch::detail
