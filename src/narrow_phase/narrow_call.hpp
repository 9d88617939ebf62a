// What one narrow-phase call is about, for all devices that work on it.
#pragma once

#include "clinch/aabb.hpp"
#include "clinch/narrow_phase.hpp"
#include "clinch/scene.hpp"
#include "clinch/view.hpp"
#include "src/narrow_phase/narrow_scene.hpp"
#include "src/narrow_phase/plans.hpp"
#include "src/narrow_phase/warm_start_impl.hpp"

namespace clinch::detail {

/// What float32 answers are good for: see NarrowPhaseOptions::precision.
enum class Level { Fast, Certain, Exact };

inline Level level_of(const NarrowPhaseOptions& options) {
    if (options.tolerance) return Level::Certain;
    return options.precision < 0.25 ? Level::Fast : options.precision < 0.75 ? Level::Certain : Level::Exact;
}

/// What holds for all calls of a narrow phase. Nothing but the plans and bodies changes while devices work.
struct NarrowSettings {
    explicit NarrowSettings(const NarrowPhaseOptions& o)
        : options(o), level(level_of(o)), shapes(o.contacts_per_pair > 1), plans(options, shapes) {}

    NarrowPhaseOptions options;
    Level level;
    NarrowShapes shapes;  ///< those of the scene of the call
    HostBodies bodies;    ///< devices bring them up to date
    /// Chunks of at most so many pairs are grouped on the host where it shares the device's memory: that is done
    /// before a device has begun with the first of some ten commands. None of them waits at this size.
    std::size_t grouped_on_host = 8192;
    Plans plans;
};

/// One call. Devices only read it, but for the corners of their own pairs.
struct NarrowCall {
    const Scene& scene;
    View<const Pair> pairs;
    bool only_pairs = false;          ///< else contacts
    WarmStart::Impl* warm = nullptr;  ///< its own, if it may use one
};

}  // namespace clinch::detail
