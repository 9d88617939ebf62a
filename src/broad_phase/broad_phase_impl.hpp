// What stands behind clinch::BroadPhase.
#pragma once

#include <map>
#include <memory>

#include "clinch/broad_phase.hpp"
#include "src/broad_phase/algorithm.hpp"
#include "src/broad_phase/incremental.hpp"
#include "src/broad_phase/pair_events.hpp"
#include "src/broad_phase/split.hpp"
#include "src/device/context_impl.hpp"

namespace clinch {
namespace detail {

/// What does not go together, or not with the context, is InvalidArgument.
void check_options(const Context::Impl& context, const BroadPhaseOptions& options);

}  // namespace detail

struct BroadPhase::Impl {
    Context::Impl& context;
    BroadPhaseOptions options;
    detail::Buffer staging;  // boxes of the host on the device
    std::map<const detail::AlgorithmRow*, std::unique_ptr<detail::BroadPhaseAlgorithm>> made;
    std::unique_ptr<detail::BroadSplit> split;         // where there are several devices
    std::unique_ptr<detail::Incremental> incremental;  // only while little changes from call to call
    detail::PairList pairs;                            // after `made`, whose buffers it may map: it ends first
    detail::PairEvents events;                         // kept up to date if the options ask for it
    Report report;
    std::uint64_t most_host_bytes = 0;
    std::uint64_t steps_refused = 0;  // number of boxes for which keeping pairs did not pay
    bool alone = false;               // several devices never share a call
    bool any_invalid = false;         // among the boxes of the last call
    std::uint64_t listed_boxes = 0;   // boxes of the last call, if `pairs` is its list; else 0

    Impl(Context& c, BroadPhaseOptions o);
    /// The algorithm for `count` boxes, given what the last report says and, if they are in host memory, `boxes`.
    const detail::AlgorithmRow& choose(std::uint64_t count, View<const Aabb> boxes = {}) const;
    /// The device that algorithms work on; opens it.
    detail::Device& device() const;
    /// Finds the pairs of `boxes` with `row`; boxes that are no boxes are listed if `list_rejected`.
    View<const Pair> find(const detail::AlgorithmRow& row, detail::BoxInput& boxes, const detail::FilterInput& filters,
                          bool list_rejected);
    /// Whether keeping pairs from call to call may pay when `changed` of `count` boxes changed.
    bool steps_pay(const detail::AlgorithmRow& row, std::uint64_t count, std::uint64_t changed) const;
    /// As find(), by what changed since the last call, boxes being in device memory. False: not done, and `boxes` may
    /// be as before the changes.
    bool step(detail::BoxInput& boxes, const detail::Changes& changes, const detail::FilterInput& filters);
    /// As find(), and begins keeping pairs if that pays.
    View<const Pair> find_to_step(const detail::AlgorithmRow& row, detail::BoxInput& boxes,
                                  const detail::FilterInput& filters, bool list_rejected);
    /// BroadPhase::update() after its checks; without a last list, find().
    View<const Pair> update(View<const Aabb> boxes, View<const std::uint32_t> changed, const FilterColumns& filters);
    /// Runs `work`, and if the device fails in it once more on another one.
    template <class Work>
    auto in_any_case(const Work& work) -> decltype(work());
    /// Before a call: what is kept is on the primary device, or given back. Events may begin from nothing then.
    void settle();
    /// Said of that in the report of the next list.
    static constexpr const char* events_lost =
        "the list of pairs before was lost with the device: all pairs are told as added";
    /// The last list once more, nothing having changed.
    View<const Pair> same_again();
    /// The same into `pairs` as it is set up.
    void run(const detail::AlgorithmRow& row, detail::BoxInput& boxes, const detail::FilterInput& filters,
             bool list_rejected);
    /// The same pairs to `take`, at most `piece` at a time. With a row of the host no device is touched.
    void stream(const detail::AlgorithmRow& row, detail::BoxInput& boxes, const detail::FilterInput& filters,
                const detail::PairList::Taker& take, std::size_t piece, bool list_rejected);
    /// Writes into the report what memory there is; not while devices work.
    void note_memory();

private:
    static constexpr std::size_t nowhere = ~std::size_t{0};
    std::size_t made_on = nowhere;  // the device that all is kept on
    bool events_were_lost = false;  // and no list has told it yet
    void drop_device();
    bool find_split(const detail::AlgorithmRow& row, detail::BoxInput& boxes, const detail::FilterInput& filters,
                    detail::FindCounts& counts);
    void find_on_one(const detail::AlgorithmRow& row, detail::BoxInput& boxes, const detail::FilterInput& filters,
                     detail::FindCounts& counts);
    void listed(std::uint64_t count);
    // After run() of these boxes. The list stays, elsewhere in memory.
    void begin_steps(detail::BoxInput& boxes, const detail::FilterInput& filters);
    void leave_steps();
    template <class Search>
    bool measured(const char* algorithm, detail::BoxInput& boxes, const Search& search);
};

}  // namespace clinch
