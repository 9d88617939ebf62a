// Broad phase: which boxes overlap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/context.hpp"
#include "clinch/report.hpp"
#include "clinch/scene.hpp"
#include "clinch/view.hpp"

namespace clinch {

/// The order of the pairs of a result.
enum class Order {
    Sorted,  ///< ascending by a, then b; the same bytes on every device with every algorithm
    Any,     ///< as they come, which may differ from run to run; some algorithms are faster so
};

struct BroadPhaseOptions {
    /// A name of broad_phase_names(), or "auto": chosen at each call from the number of boxes, how many
    /// pairs they had in the last call, and whether there is a device.
    std::string algorithm = "auto";
    Order order = Order::Sorted;
    /// More pairs than this is Error LimitExceeded, which names the true count. Nothing is ever cut off.
    std::uint64_t max_pairs = UINT64_MAX;
    /// Device memory for work in between (bit buffers); larger means fewer passes. Pairs wait in up to
    /// four times as much. At least what one row of boxes needs is taken.
    std::size_t scratch_bytes = std::size_t{64} << 20;
    /// Tell at each list of find() and update() which pairs are new in it and which are gone: added() and removed().
    /// Costs a pass over the list and a copy of it, or next to nothing where update() knows what changed. With
    /// Order::Any it is InvalidArgument.
    bool events = false;
    /// Room for the pairs that stream() hands over at a time, on the device and on the host.
    std::size_t stream_bytes = std::size_t{64} << 20;
    /// Called now and then during long work with the share done, 0 to 1; may throw to stop the work. Where several
    /// devices share the work, on their threads, but never twice at once.
    std::function<void(double)> progress;
    /// Wait for the device after each stage, so that StageTimes are those of the stages (costs a
    /// few tens of microseconds a stage).
    bool measure_stages = false;
};

/// Columns that decide which overlapping boxes are pairs, one entry a box; a null pointer stands for
/// the default in every row (group 1, mask all ones, Dynamic). Read during the call only.
struct FilterColumns {
    const std::uint32_t* group = nullptr;
    const std::uint32_t* mask = nullptr;
    const Motion* motion = nullptr;
};

/// Names of the algorithms, in the order of the registry, "auto" not among them.
std::vector<std::string> broad_phase_names();

/// Finds all pairs of overlapping boxes; keeps its buffers between calls. Usable alone, without a Scene.
class BroadPhase {
public:
    /// An unknown algorithm, or one that needs a device on a Context without, is InvalidArgument.
    /// `context` must outlive this object. Builds nothing yet.
    explicit BroadPhase(Context& context, BroadPhaseOptions options = {});
    ~BroadPhase();
    BroadPhase(BroadPhase&& other) noexcept;
    BroadPhase& operator=(BroadPhase&& other) noexcept;

    /// All pairs of `boxes` that overlap (closed boxes: touching counts) and pass `filters`, in the
    /// order asked for. A pair's numbers are indices into `boxes`; at most 2^32 - 1 boxes. Invalid boxes pair with
    /// none and are listed in report().rejected. The result is readable host memory, valid until the
    /// next call or the end of this object. Throws Error; then there is no result.
    View<const Pair> find(View<const Aabb> boxes, const FilterColumns& filters = {});

    /// As find(), for boxes of which only some changed since the last call of find() or update(): `changed` are their
    /// numbers, in any order, and may name boxes that did not change; a box whose group, mask or motion changed
    /// is to be among them. When they are few among many boxes (with "auto" or "grid"), the list is kept from call to
    /// call, only pairs of boxes that have changed are tested again, and only boxes that left a slightly larger box are
    /// looked for again; the first such call costs about twice a find(). When they are many (more than a sixteenth; in
    /// several calls together more than an eighth makes one of them a first one again), or the number of boxes is
    /// another one, or nothing was found yet, this is find(). When there are none, it is the last result. The result
    /// is that of find(), with Order::Sorted. A number that is no box is InvalidArgument.
    View<const Pair> update(View<const Aabb> boxes, View<const std::uint32_t> changed,
                            const FilterColumns& filters = {});

    /// The pairs that find() would list, handed to `take` piece by piece: every pair once, at most stream_bytes of
    /// them at a time (8 bytes a pair), so that memory does not grow with the result. A piece is valid during
    /// the call of `take`; with Order::Sorted the pairs of a piece ascend, but not from piece to piece.
    /// Returns the number of pairs. When there are more pairs than a piece holds, boxes are searched about twice: once
    /// to count, unless the call before was a stream, too. Where several devices share the work, `take` is called in
    /// their threads, but never twice at once. More than max_pairs is LimitExceeded, maybe after some pieces. What
    /// `take` throws ends the call; so does a device that fails after the first piece.
    std::uint64_t stream(View<const Aabb> boxes, const std::function<void(View<const Pair>)>& take,
                         const FilterColumns& filters = {});

    /// The number of pairs that find() would list; no pair is stored.
    std::uint64_t count(View<const Aabb> boxes, const FilterColumns& filters = {});

    /// With BroadPhaseOptions::events: the pairs of the last list that were not in the list before, ascending; at the
    /// first list all. Lists are those of find() and update(); after an error the last one before it counts. Valid
    /// until the next call.
    View<const Pair> added() const noexcept;
    /// The pairs that were in the list before and are not in the last one, ascending.
    View<const Pair> removed() const noexcept;

    /// Counts and times of the last call; of one that threw there are none.
    const Report& report() const noexcept;

    /// The library's own view; not for users.
    struct Impl;
    Impl& impl() const noexcept { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace clinch
