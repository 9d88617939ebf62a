// A sorted list of pairs on a device that is brought up to date in place. See cl/broad_phase/kept_list.cl.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/view.hpp"
#include "src/device/device.hpp"
#include "src/primitives/pair_sort.hpp"

namespace clinch::detail {

/// Pairs that few others join and leave at a time. Memory on the device: 8 bytes a pair, a sixteenth more as room
/// to grow, and up to 1 byte a pair while edits are made.
class KeptList {
public:
    explicit KeptList(Device& device) : device_(device) {}

    /// Begins with these pairs of numbers below `bodies`, fewer than 2^32, ascending if `sorted`; else they are
    /// sorted here.
    void begin(View<const Pair> pairs, std::uint32_t bodies, bool sorted);
    /// Room for edits of this size, and for a list that grows so, so that edit() allocates nothing. May throw; then
    /// copy() still gives the list, and begin() is to be next.
    void make_room(std::size_t added, std::size_t removed);
    /// Adds pairs that are not in the list and takes pairs that are, both ascending; after make_room() for them. Cost:
    /// a read and a write of the pairs behind the first edit. May throw; then copy() gives the list after some of the
    /// edits, and begin() is to be next.
    void edit(View<const Pair> added, View<const Pair> removed);

    std::uint32_t size() const noexcept { return size_; }
    /// The pairs in host memory. Waits.
    std::vector<Pair> copy();
    /// The pairs; for 0 of them nothing. Ends before the next edit().
    Mapping map() { return device_.map(pairs_, std::size_t{size_} * sizeof(Pair)); }

private:
    struct Edit {
        std::uint32_t a, b, adds;
        std::int32_t shift;
    };
    static_assert(sizeof(Edit) == 16, "kernels read this layout");
    struct Shape {
        std::uint32_t halo, block, blocks;
    };
    void reserve_pairs(std::size_t pairs);
    Shape shape_for(std::uint32_t most_shift) const;
    void run(View<const Edit> edits, std::int32_t shift_at_end, std::uint32_t most_shift);

    Device& device_;
    Kernel locate_, save_, edit_;
    Buffer pairs_, edits_, at_, saved_;
    std::vector<Pair> on_host_;  // the pairs, when there was no room for more of them
    std::uint32_t size_ = 0;
};

}  // namespace clinch::detail
