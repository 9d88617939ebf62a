// A call of the narrow phase whose pairs come in chunks, in any order, while it runs [thesis 6.1].
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/scene.hpp"
#include "clinch/view.hpp"
#include "src/narrow_phase/contact_order.hpp"
#include "src/narrow_phase/narrow_phase_impl.hpp"
#include "src/narrow_phase/narrow_result.hpp"

namespace clinch::detail {

/// The result is, byte for byte, that of NarrowPhase::find for all pairs at once, ascending. Keeps its memory from
/// call to call.
class NarrowStream {
public:
    /// `narrow` must outlive this object, and is what report and result are written to.
    explicit NarrowStream(NarrowPhase::Impl& narrow) : narrow_(narrow) {}

    /// A call begins. Returns the devices that may work on it, the primary one first; none: only the host may. Opens
    /// none.
    std::vector<std::size_t> begin(const Scene& scene);
    /// Fewer pairs than this, if there are no more in the call, are the host's.
    static constexpr std::size_t few_pairs = NarrowPhase::Impl::few_pairs;
    /// Finds what the pairs have. In the thread of that device; several devices at once. Throws what went wrong.
    void find(std::size_t device, View<const Pair> pairs);
    /// The same on the host; in one thread.
    void find_on_host(View<const Pair> pairs);
    /// When all is done: puts the contacts of all in the order of their pairs, and completes the report but for times.
    void finish();
    /// Instead, when something failed: nothing is left of the call.
    void abandon();

private:
    NarrowPhase::Impl& narrow_;
    const Scene* scene_ = nullptr;
    std::map<std::size_t, std::unique_ptr<NarrowResult>> found_;  // of each device
    bool devices_ = false;                                        // may work on the call
    NarrowResult on_host_;
    ContactOrder order_;
    std::size_t pairs_on_host_ = 0;
};

}  // namespace clinch::detail
