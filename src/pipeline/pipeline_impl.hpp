// What stands behind clinch::Pipeline.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "clinch/pipeline.hpp"
#include "src/broad_phase/broad_phase_impl.hpp"
#include "src/broad_phase/pair_events.hpp"
#include "src/broad_phase/planes.hpp"
#include "src/pipeline/phase_stream.hpp"
#include "src/scene/bounds.hpp"

namespace clinch {

struct StepResult::Impl {
    Impl(Context& context, const PipelineOptions& options);

    BroadPhase broad;
    bool measure, tell_events, starts_warm;
    detail::PairEvents events;
    std::optional<detail::DeviceBounds> device_bounds;
    std::optional<detail::HostBounds> host_bounds;
    detail::PlanePairs planes;
    std::uint64_t filter_version = 0;  // names the filters of a scene for the broad phase; 0: none seen
    std::uint64_t scene_filter_version = 0;
    std::shared_ptr<const int> scene_identity;
    bool filters_changed = false;                 // since the last step
    std::shared_ptr<const int> stepped_identity;  // of the scene of the last step, if it succeeded
    std::uint64_t stepped_version = 0;
    std::size_t stepped_rows = 0;

    View<const Pair> pairs;
    std::vector<Pair> merged;  // holds `pairs` when planes added to them
    bool on_device = false;    // where the boxes of the last step are
    std::size_t rows = 0;
    std::optional<std::vector<Aabb>> boxes_read;
    std::optional<NarrowPhase> narrow;            // if contacts are asked for
    std::unique_ptr<detail::PhaseStream> phases;  // if both phases are to work at once
    WarmStart kept;                               // if they start warm
    View<const Contact> contacts;
    NarrowReport narrow_report;
    std::uint64_t most_contacts = 0;
    Report report;
    StepResult result;

    void step(const Scene& scene);
    void find_listed(const Scene& scene, const detail::AlgorithmRow& row);
    detail::PhaseStream::Prepared prepare(const Scene& scene);
    void find_streamed(const Scene& scene, const detail::AlgorithmRow& row);
    bool nothing_changed(const Scene& scene) const;
    void step_again();
    void start_afresh();
    void leave_bounds();
    void make_boxes(const Scene& scene);
    std::size_t make_boxes_on_device(const Scene& scene);
    std::size_t make_boxes_on_host(const Scene& scene);
    detail::FilterInput filters(const Scene& scene);
    View<const Pair> find_changed(const detail::AlgorithmRow& row, const detail::FilterInput& filters);
    const std::vector<Pair>& find_plane_pairs(const Scene& scene);
    void add_plane_pairs(const Scene& scene);
    void take_contacts();
    View<const Aabb> boxes();
};

}  // namespace clinch
