// The incremental path: between steps in which little changes, only what changed is looked at again.
// See cl/broad_phase/incremental.cl.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "src/broad_phase/grid.hpp"
#include "src/broad_phase/kept_list.hpp"

namespace clinch::detail {

/// What changed since the last step.
struct Changes {
    View<const std::uint32_t> bodies;  ///< their boxes or filters may have changed; in any order, also more than once
    /// The new boxes of these bodies; null when the device memory of the boxes has them already.
    const Aabb* boxes = nullptr;
    /// The filters of bodies that are not among them may have changed too.
    bool any_filter = false;
};

/// Keeps the list of pairs from step to step. Results are those of a full search, in sorted order.
/// Cost of a step: a test for each pair of a fattened box of a body that has changed since build(), a search of a few
/// cells for each body that has left its fattened box, and a read and a write of the list if it changes. Memory on the
/// device: about 50 bytes a body besides its box, 120 more for each that has changed since build(), and 10 a pair.
class Incremental {
public:
    /// More pairs a body than this: going through them costs as much as searching.
    static constexpr std::uint64_t most_pairs_a_body = 32;
    /// At most so large a part of the bodies may change in a step: beyond, searching costs less.
    static constexpr std::uint64_t bodies_a_change = 16;

    Incremental(Device& device, const BroadPhaseOptions& options);

    /// Whether update() may be called: build() succeeded and nothing was forgotten since.
    bool valid() const noexcept { return bodies_ != 0; }
    void forget() noexcept { bodies_ = 0; }
    std::size_t host_bytes() const noexcept;
    /// Begins with these boxes, whose pairs are `pairs`, ascending if `sorted`. False when keeping pairs does not pay
    /// here: next to no boxes, very many pairs a body, or more pairs than one buffer holds.
    bool build(BoxInput& boxes, const FilterInput& filters, View<const Pair> pairs, bool sorted);
    /// The same boxes after `changes`. Where these bring their boxes, the device memory of the boxes stays as it is,
    /// and is to be so in later steps too. False, with nothing found, when so much has changed that it does not pay,
    /// and then it is no longer valid. Throws Error; then it is not valid either.
    bool update(BoxInput& boxes, const Changes& changes, const FilterInput& filters, PairList& pairs,
                FindCounts& counts);
    /// What the last update() changed in the list; ascending.
    View<const Pair> added() const noexcept { return added_; }
    View<const Pair> removed() const noexcept { return removed_; }
    /// The list after a build() or update() that succeeded; to be unmapped before the next.
    Mapping map_list() { return list_.map(); }
    /// The list of the last build() or update() that succeeded, also after an update() that failed. Waits.
    std::vector<Pair> last_list();
    std::uint32_t list_size() const noexcept { return list_.size(); }

private:
    static constexpr std::uint32_t none = 0xffffffffu;
    // A body that has left its fattened box, or has none yet, or whose filters changed; as inc_move reads it.
    struct Leaver {
        std::uint32_t body, mover, row, bits;
    };
    // As the structs of incremental.cl.
    struct Mover {
        float now[6], old[6];
        std::uint32_t changed, left, fresh, body;
    };
    struct Fat {
        float box[6];
        std::uint32_t node, body;
    };
    static_assert(sizeof(Mover) == 64 && sizeof(Fat) == 32, "kernels write this layout");
    // Numbers of the two sides: bodies_ + that of a mover; the second may be the body where that is no mover.
    struct LivePair {
        std::uint32_t p, q;
    };
    struct Begun {
        std::uint32_t place, p, q, unused;
    };
    struct SearchKernels {
        Kernel grid, movers;
    };
    struct FilterRow {
        std::uint32_t group, mask;
        bool can_move;
        bool operator!=(const FilterRow& o) const {
            return group != o.group || mask != o.mask || can_move != o.can_move;
        }
        bool allows(const FilterRow& o) const {
            return (group & o.mask) != 0 && (o.group & mask) != 0 && (can_move || o.can_move);
        }
    };
    using FilterChange = std::pair<std::uint32_t, FilterRow>;

    bool step(BoxInput& boxes, const Changes& changes, const FilterInput& filters, FindCounts& counts);
    std::uint64_t most_pairs() const;
    void make_kernels();
    void write_cells();
    Changes ordered(const Changes& changes);
    void apply(BoxInput& boxes, const Changes& changes);
    void find_leavers(BoxInput& boxes, const Changes& changes, const FilterInput& filters);
    void leave(std::uint32_t body, std::uint32_t row, std::uint32_t bits);
    std::vector<FilterChange> filter_changes(const Changes& changes, const FilterInput& filters);
    FilterRow filter_row(const FilterInput& filters, std::uint32_t body) const;
    bool search(BoxInput& boxes, const Changes& changes, const FilterInput& filters, FindCounts& counts);
    void make_room_for_movers();
    template <class T>
    void grow(Buffer& buffer, std::uint32_t before);
    void make_room_for_pairs(std::size_t more);
    void find_old_pairs(FindCounts& counts);
    void move(BoxInput& boxes, const Changes& changes);
    void launch_runs(const Kernel& kernel, std::uint32_t count);
    void test(BoxInput& boxes);
    void begin_pairs(BoxInput& boxes, View<const Pair> found);
    void take_states();
    void take_state(std::uint32_t live, std::uint8_t state);
    std::uint32_t side(std::uint32_t body) const { return mover_of_[body] == none ? body : bodies_ + mover_of_[body]; }
    std::uint32_t body(std::uint32_t side) const { return side < bodies_ ? side : mover_bodies_[side - bodies_]; }
    void cancel();

    Device& device_;
    const BroadPhaseOptions& options_;
    BroadPhaseOptions search_options_;
    Grid grid_;
    PairSink sink_;
    KeptList list_;
    Kernel places_, apply_, move_, link_, test_, begin_, query_old_;
    SearchKernels search_kernels_[2];  // without and with filters
    Buffer place_, changed_, rows_, marks_, leavers_buffer_, movers_, fats_, cells_, heads_, nodes_, live_buffer_,
        begun_, states_buffer_;
    std::vector<std::uint32_t> mover_of_;      // of each body; none
    std::vector<std::uint32_t> mover_bodies_;  // of each mover
    std::vector<std::uint32_t> leaver_of_;     // of each mover in this step; none
    std::vector<Leaver> leavers_;
    std::vector<LivePair> live_;       // as on the device, but for those that have died there
    std::vector<std::uint32_t> free_;  // places among the live pairs
    std::vector<std::uint8_t> states_;
    std::vector<std::uint32_t> ordered_, marks_read_;
    std::vector<Aabb> ordered_rows_;
    std::vector<Pair> added_, removed_;
    std::vector<FilterChange> filter_changes_;  // in this step
    std::vector<FilterRow> filter_rows_;        // as of the last step; empty when every pair passes
    std::uint64_t filter_version_ = 0;          // of filter_rows_, for the device's copy
    std::uint32_t bodies_ = 0, frame_ = 0, firsts_ = 0, mover_room_ = 0, nodes_used_ = 0, chains_ = 0, run_ = 1;
    bool any_invalid_ = false;
    bool editing_ = false;  // the list may have some of added_ and lack some of removed_, in a step that is not done
};

}  // namespace clinch::detail
