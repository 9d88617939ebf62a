// One step of collision detection over a Scene.
#pragma once

#include <memory>

#include "clinch/aabb.hpp"
#include "clinch/broad_phase.hpp"
#include "clinch/contact.hpp"
#include "clinch/context.hpp"
#include "clinch/narrow_phase.hpp"
#include "clinch/report.hpp"
#include "clinch/scene.hpp"
#include "clinch/view.hpp"

namespace clinch {

struct PipelineOptions {
    BroadPhaseOptions broad_phase;
    /// Find the contacts of the pairs, too. Off: no narrow phase, and nothing of it is built, allocated or sent.
    bool contacts = false;
    NarrowPhaseOptions narrow_phase;
    /// Broad and narrow phase at once: pairs go from one to the other in chunks and are not kept, so that memory for
    /// them does not grow with their number: StepResult::pairs() is empty, and Report::stream tells what went by. Where
    /// there are several devices some find pairs, as many as measured times say is best, and the others contacts; who
    /// is done early helps. The contacts are, byte for byte, those of a step that does not stream; with Order::Any they
    /// come in any order, those of a pair together, which saves a copy of them. A step whose scene has changed finds
    /// all pairs anew. Needs `contacts`; with events or a warm start it is InvalidArgument.
    bool streaming = false;
    /// Start the narrow phase of each step from what decided the pairs in the last one: see WarmStart.
    bool warm_start = false;
};

/// What a step found. Views are valid until the pipeline's next step or its end.
class StepResult {
public:
    /// Candidate pairs of body indices: boxes overlap, or a box reaches into a plane, and the
    /// filters of both bodies allow it. In the order BroadPhaseOptions asks for. Empty with PipelineOptions::streaming.
    View<const Pair> pairs() const;
    /// With BroadPhaseOptions::events: the pairs that were not there, or are no longer there, after the step before,
    /// ascending. After a step that failed the last one before it counts.
    View<const Pair> added() const noexcept;
    View<const Pair> removed() const noexcept;
    /// The box of every row, world space, float32, rounded outward: it holds the exact shape grown
    /// by the body's margin. Rows without a box (rejected, removed, planes) hold NaN. Copied from
    /// the device when first asked for: 24 bytes a row.
    View<const Aabb> boxes() const;
    const Report& report() const noexcept;
    /// With PipelineOptions::contacts: the contacts of pairs(), in their order (with
    /// PipelineOptions::streaming ascending, or, with Order::Any, in any); see NarrowPhase::find. Empty without.
    View<const Contact> contacts() const noexcept;
    /// What the narrow phase did in this step; of a step in which nothing had changed the counts are those of the
    /// step that found the contacts, and the times are 0.
    const NarrowReport& narrow_report() const noexcept;

    /// The library's own view; not for users.
    struct Impl;
    explicit StepResult(Impl& impl) noexcept : impl_(&impl) {}

private:
    Impl* impl_;
};

/// Steps scenes: bounds, then broad phase, then, if asked for, narrow phase. Keeps boxes, pairs, contacts and buffers
/// between steps, so that stepping the same scene again costs only what changed in it, and next to nothing when
/// nothing did.
class Pipeline {
public:
    /// `context` must outlive this object. Builds nothing yet. Errors as BroadPhase and NarrowPhase.
    explicit Pipeline(Context& context, const PipelineOptions& options = {});
    ~Pipeline();
    Pipeline(Pipeline&& other) noexcept;
    Pipeline& operator=(Pipeline&& other) noexcept;

    /// Finds the candidate pairs, and the contacts, of the scene as it stands. Meaningless bodies are left out and
    /// listed in the report. With PipelineOptions::contacts a pair with a mesh is InvalidArgument. Throws Error; the
    /// next step then starts afresh.
    const StepResult& step(const Scene& scene);

    /// Forgets what PipelineOptions::warm_start has kept: the next step that finds contacts anew does so from nothing.
    void drop_warm_start() noexcept;

    /// The library's own view; not for users.
    StepResult::Impl& impl() const noexcept { return *impl_; }

private:
    std::unique_ptr<StepResult::Impl> impl_;
};

}  // namespace clinch
