// What stands behind clinch::NarrowPhase: one call, on the host or on devices.
#pragma once

#include <cstddef>

#include "clinch/narrow_phase.hpp"
#include "src/device/context_impl.hpp"
#include "src/narrow_phase/narrow_call.hpp"
#include "src/narrow_phase/narrow_devices.hpp"
#include "src/narrow_phase/narrow_member.hpp"

namespace clinch {

struct NarrowPhase::Impl {
    Impl(Context& c, const NarrowPhaseOptions& o);

    Context::Impl& context;
    detail::NarrowSettings settings;
    detail::NarrowDevices devices;
    detail::NarrowResult result;
    NarrowReport report;

    void find(const Scene& scene, View<const Pair> pairs, bool touching_only, WarmStart* from);
    bool worth_a_device(std::size_t pairs) const;
    void find_somewhere(const detail::NarrowCall& call);
    void find_on_host(const detail::NarrowCall& call);
    void finish_report(bool touching_only);
};

}  // namespace clinch
