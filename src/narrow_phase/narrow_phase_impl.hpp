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
    /// A call begins: nothing is found yet, shapes are known.
    void begin(const Scene& scene);
    /// Fewer than this are done on the host before a device has been told of them.
    static constexpr std::size_t few_pairs = 128;
    bool worth_a_device(std::size_t pairs) const;
    void find_somewhere(const detail::NarrowCall& call);
    /// Appends what the pairs have to `to`, and adds them to the report's buckets.
    void find_on_host(const detail::NarrowCall& call, detail::NarrowResult& to);
    /// When all is found.
    void finish_report(bool touching_only);
};

}  // namespace clinch
