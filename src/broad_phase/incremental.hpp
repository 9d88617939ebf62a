// The incremental path: between steps in which little changes, only what changed is looked at again.
// See cl/broad_phase/incremental.cl.
#pragma once

#include <cstdint>
#include <vector>

#include "src/broad_phase/grid.hpp"

namespace clinch::detail {

/// What changed since the last step.
struct Changes {
    View<const std::uint32_t> bodies;  ///< ascending; their boxes or filters may have changed
    /// The new boxes of these bodies; null when the device memory of the boxes has them already.
    const Aabb* boxes = nullptr;
    /// The filters of bodies that are not among them may have changed too.
    bool any_filter = false;
};

/// Keeps the pairs of fattened boxes from step to step. Results are those of a full search, in sorted order.
/// Cost of a step: a few tests a changed body, a search of a few cells for each that has left its fattened box, and one
/// pass over the pairs. Memory on the device: up to about 200 bytes a body and 30 a pair of fattened boxes.
class Incremental {
public:
    /// More pairs a body than this: going through them costs as much as searching.
    static constexpr std::uint64_t most_pairs_a_body = 32;

    Incremental(Device& device, const BroadPhaseOptions& options);

    /// Whether update() may be called: build() succeeded and nothing was forgotten since.
    bool valid() const noexcept { return bodies_ != 0; }
    void forget() noexcept { bodies_ = 0; }
    std::size_t host_bytes() const noexcept {
        return extra_.capacity() * sizeof(Pair) + filter_rows_.capacity() * sizeof(FilterRow) +
               spare_entry_.capacity() * sizeof(std::uint32_t) + left_now_.capacity() * sizeof(std::uint64_t);
    }
    /// Begins with these boxes. False, with nothing found, when keeping pairs does not pay here: next to no boxes, very
    /// many pairs a body, or more pairs than one buffer holds.
    bool build(BoxInput& boxes, const FilterInput& filters, PairList& pairs, FindCounts& counts);
    /// The same boxes after `changes`, in the same device memory. False, with nothing found, when so much has changed
    /// that it does not pay, and then it is no longer valid. Throws Error; then it is not valid either.
    bool update(BoxInput& boxes, const Changes& changes, const FilterInput& filters, PairList& pairs,
                FindCounts& counts);

private:
    struct Leaver {
        std::uint32_t body, entry;
    };
    struct QueryKernels {
        Kernel grid, spare;
    };
    struct FilterRow {
        std::uint32_t group, mask;
        bool can_move;
        bool operator!=(const FilterRow& o) const {
            return group != o.group || mask != o.mask || can_move != o.can_move;
        }
    };
    bool step(BoxInput& boxes, const Changes& changes, const FilterInput& filters, PairList& pairs, FindCounts& counts);
    std::uint64_t most_pairs() const;
    void keep_pairs(View<const Pair> fat_pairs, std::uint32_t bodies);
    void compute_states(BoxInput& boxes);
    std::vector<Leaver> find_leavers(BoxInput& boxes, const Changes& changes, const FilterInput& filters);
    void leave(std::uint32_t body, std::vector<Leaver>& leavers);
    bool has_left(std::uint32_t body) const { return (left_now_[body / 64] >> body % 64 & 1) != 0; }
    std::vector<std::uint32_t> filter_changes(const Changes& changes, const FilterInput& filters);
    FilterRow filter_row(const FilterInput& filters, std::uint32_t body) const;
    void move(BoxInput& boxes, const std::vector<Leaver>& leavers);
    void query(const std::vector<Leaver>& leavers, const FilterInput& filters, FindCounts& counts);
    void retest(BoxInput& boxes, const Changes& changes);
    void put_out(PairList& pairs, FindCounts& counts);
    void make_kernels();

    Device& device_;
    const BroadPhaseOptions& options_;
    BroadPhaseOptions fat_options_, query_options_;
    Grid grid_;
    PairSink sink_;
    RadixSort sort_;
    Scan scan_;
    Kernel fatten_, places_, split_, first_rows_, states_kernel_, apply_, move_, retest_, extra_kernel_, count_, fill_;
    QueryKernels query_kernels_[2];  // without and with filters
    Buffer leaver_columns_, leaver_ids_, changed_, rows_, marks_, leavers_, place_, left_, a_, b_, by_b_, first_of_a_,
        first_of_b_, states_, extra_buffer_, extra_states_, counts_, offsets_, out_;
    std::vector<Pair> extra_;                 // pairs of fattened boxes of bodies that have left, ascending
    std::vector<std::uint32_t> spare_entry_;  // of each body; none
    std::vector<std::uint64_t> left_now_;     // a bit for each body that has left in this step
    std::vector<FilterRow> filter_rows_;      // as of the last step; empty when every pair passes
    std::uint64_t filter_version_ = 0;        // of filter_rows_, for the device's copy
    std::uint32_t bodies_ = 0, kept_ = 0, frame_ = 0, spare_used_ = 0, spare_room_ = 0;
    bool any_invalid_ = false;
};

}  // namespace clinch::detail
