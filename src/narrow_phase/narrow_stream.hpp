// A call of the narrow phase whose pairs come in chunks, in any order, while it runs [thesis 6.1].
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/scene.hpp"
#include "clinch/view.hpp"
#include "src/narrow_phase/contact_order.hpp"
#include "src/narrow_phase/narrow_phase_impl.hpp"
#include "src/narrow_phase/narrow_result.hpp"
#include "src/narrow_phase/row_list.hpp"

namespace clinch::detail {

/// The result is, byte for byte, that of NarrowPhase::find for all pairs at once, ascending; or the same contacts in
/// any order, those of a pair together. Keeps its memory from call to call.
class NarrowStream {
public:
    /// `narrow` must outlive this object, and is what report and result are written to.
    NarrowStream(NarrowPhase::Impl& narrow, bool sorted) : narrow_(narrow), sorted_(sorted) {}

    /// A call begins. Returns the devices that may work on it, the primary one first; none: only the host may. Opens
    /// none.
    std::vector<std::size_t> begin(const Scene& scene);
    /// Fewer pairs than this, if there are no more in the call, are the host's.
    static constexpr std::size_t few_pairs = NarrowPhase::Impl::few_pairs;
    /// Sends that device what it needs of the scene, before the first find(). As that.
    void prepare(std::size_t device) { narrow_.devices.prepare_stream(device, {*scene_, {}, false, nullptr}); }
    /// Finds what the pairs have. In the thread of that device; several devices at once. Throws what went wrong.
    void find(std::size_t device, View<const Pair> pairs);
    /// The same on the host; in one thread, while no device is at work.
    void find_on_host(View<const Pair> pairs);
    /// When all is done: puts the contacts in order if they are to be, and completes the report but for times.
    void finish();
    /// Instead, when something failed: nothing is left of the call.
    void abandon();

private:
    NarrowResult& found() noexcept { return sorted_ ? unordered_ : narrow_.result; }
    void put_in_order();

    NarrowPhase::Impl& narrow_;
    bool sorted_;
    const Scene* scene_ = nullptr;
    bool devices_ = false;              // may work on the call
    std::atomic<std::size_t> next_{0};  // row of found() that no device has taken
    NarrowResult unordered_;
    RowList<std::uint64_t> keys_;  // of its rows
    ContactOrder order_;
    std::size_t pairs_on_host_ = 0;
};

}  // namespace clinch::detail
