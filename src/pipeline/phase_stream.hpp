// Broad and narrow phase of a step at once: some devices find pairs, the others what those have in common, chunk by
// chunk [thesis 6.1].
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/report.hpp"
#include "clinch/scene.hpp"
#include "src/broad_phase/broad_phase_impl.hpp"
#include "src/broad_phase/split.hpp"
#include "src/narrow_phase/narrow_stream.hpp"
#include "src/pipeline/phase_run.hpp"
#include "src/schedule/phase_balance.hpp"

namespace clinch::detail {

/// Keeps, from step to step, how many devices the broad phase has, which moves by measured times (PhaseBalance), and
/// the buffers. Whoever is done early, or finds the buffer full, helps the narrow phase, if its answers are those of
/// the primary device.
class PhaseStream {
public:
    /// `context` and `narrow` must outlive this object.
    PhaseStream(Context& context, const BroadPhaseOptions& options, NarrowPhase::Impl& narrow);

    /// What the broad phase begins with.
    struct Prepared {
        BoxInput boxes;
        FilterInput filters;
        const std::vector<Pair>& more_pairs;  ///< any order: they go first
    };
    /// What a step is about.
    struct Step {
        const Scene& scene;
        const AlgorithmRow& row;
        /// Called once, in the caller's thread, while other devices than the primary one may be at work; with a row of
        /// the host it may touch none.
        std::function<Prepared()> prepare;
    };
    /// What a step did.
    struct Done {
        FindCounts counts;
        std::uint64_t pairs = 0, more_pairs = 0;  ///< all, and of those, Prepared::more_pairs
        double broad_ms = 0.0;                    ///< from Step::prepare() to the last pair
        double narrow_ms = 0.0;                   ///< until all were done, from before that
        StreamWork work;
        std::vector<DeviceWork> broad_split;  ///< as Report::broad_split
    };
    /// Finds the contacts of all pairs; the result is NarrowPhase's. Throws DeviceFault for a device that failed, else
    /// Error; then nothing is left of the step.
    Done run(const Step& step);

    /// For tests and benchmarks: not a device helps the other phase; how many devices the broad phase has (0: by
    /// measured times); pairs of a chunk (0: by the last step).
    struct Forced {
        bool no_help = false;
        unsigned broad_devices = 0;
        std::size_t chunk_pairs = 0;
    } forced;

private:
    PhaseRoles roles_for(const AlgorithmRow& row, const std::vector<std::size_t>& alike, std::uint64_t bodies);
    std::size_t least_chunk() const;
    std::size_t chunk_pairs(std::uint64_t expected) const;
    bool in_place(const PhaseRoles& roles) const;
    void find_pairs(const Step& step, Prepared& ready, const PhaseRoles& roles, PhaseRun& phases, FindCounts& counts);
    void find_in_place(const Step& step, Prepared& ready, PhaseRun& phases, FindCounts& counts);
    void learn(const PhaseRun& phases, const PhaseRoles& roles);

    Context::Impl& context_;
    BroadPhaseOptions options_;
    BroadPhase broad_;  // of the primary device, or the host
    NarrowStream narrow_;
    BroadSplit split_;          // of several, or another one
    double in_place_ms_ = 0.0;  // of the last search on the primary device
    std::optional<PhaseBalance> balance_;
    unsigned balanced_ = 0;  // units that it has
    std::uint64_t last_pairs_ = 0;
    double last_pair_ms_ = 0.0;  // a device's time for one
    PhaseRun::Memory memory_;
};

}  // namespace clinch::detail
