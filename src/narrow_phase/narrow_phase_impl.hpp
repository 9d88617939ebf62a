// What stands behind clinch::NarrowPhase: one call, on the host or on a device.
#pragma once

#include <cstddef>
#include <memory>

#include "clinch/narrow_phase.hpp"
#include "src/device/context_impl.hpp"
#include "src/narrow_phase/chunk_work.hpp"
#include "src/narrow_phase/contact_list.hpp"
#include "src/narrow_phase/narrow_call.hpp"
#include "src/narrow_phase/narrow_worker.hpp"

namespace clinch {

struct NarrowPhase::Impl {
    Impl(Context& c, const NarrowPhaseOptions& o);

    Context::Impl& context;
    detail::NarrowSettings settings;
    std::unique_ptr<detail::NarrowWorker> worker;
    std::unique_ptr<detail::ChunkWork> work;
    detail::ContactList contacts;
    detail::RowList<Pair> touching;
    NarrowReport report;

    void find(const Scene& scene, View<const Pair> pairs, bool touching_only, WarmStart* from);
    bool worth_a_device(std::size_t pairs) const;
    void find_on_host(const detail::NarrowCall& call);
    void find_on_device(const detail::NarrowCall& call);
    void append(const detail::NarrowCall& call, detail::ChunkContacts& chunk);
    void finish_report(bool touching_only);
};

}  // namespace clinch
