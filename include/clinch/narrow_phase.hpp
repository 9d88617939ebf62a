// Narrow phase: which of the candidate pairs touch, where and how deeply.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/contact.hpp"
#include "clinch/context.hpp"
#include "clinch/scene.hpp"
#include "clinch/view.hpp"
#include "clinch/warm_start.hpp"

namespace clinch {

struct NarrowPhaseOptions {
    /// Speed against precision, 0 (fastest) to 1 (most exact): of each pair of classes the fastest way that keeps it,
    /// by measured times and errors (docs/accuracy.md). Below 0.25: float32 alone, to 1e-4 of the pair's size at 0 and
    /// 1e-6 at 0.25; an answer whose `error` reaches across 0 is one the shapes may or may not touch by. From 0.25 on:
    /// float32, and float64 for every pair of which float32 cannot tell whether it touches. From 0.75 on: float64 for
    /// all.
    double precision = 0.5;
    /// Instead of `precision`: the error that answers may have, in the scene's unit of length. Pairs of which float32
    /// cannot promise it are done in float64, all at once where that holds of most; those that still miss it are
    /// counted in NarrowReport::tolerance_missed.
    std::optional<double> tolerance;
    /// Most points of a pair's manifold, 1 to 8. 1: the witness points alone, `feature` 0. More: of where a face, or
    /// the line of a round side, lies along the other body, the points that hold the two apart together, too. They
    /// share the normal, and each point's distance is that along the normal, there. The deepest, which has the distance
    /// and error of the pair, is always among them; the others are spread around it, and within the margins.
    std::uint32_t contacts_per_pair = 1;
    /// Wait for the device after each stage, so that NarrowTimes are those of the stages.
    bool measure_stages = false;
};

/// Milliseconds of wall time a stage took. Where several devices shared a call, the stages are the sums of what their
/// threads spent, so that they may be more than `total`.
struct NarrowTimes {
    double total = 0.0;
    double upload = 0.0;     ///< changed bodies and shapes, and the pairs
    double buckets = 0.0;    ///< grouping pairs by the classes of their shapes
    double routines = 0.0;   ///< computing the answers
    double manifolds = 0.0;  ///< the further points of contacts
    double gather = 0.0;     ///< contacts into one list, on the host
};

/// One cell of the algorithm matrix that had work.
struct BucketReport {
    std::string classes;      ///< as "sphere-box"
    std::string routine;      ///< name of the routine that ran
    std::string numbers;      ///< it computed with: "float32", "float64", or "float32, float64" for pairs left open
    std::uint64_t pairs = 0;  ///< candidates
    std::uint64_t again = 0;  ///< of those, done in float64 after float32 could not decide
};

/// What one device did of a call.
struct DeviceShare {
    std::size_t device = 0;    ///< its place in Context::devices()
    std::uint64_t pairs = 0;   ///< candidates it looked at
    std::uint64_t chunks = 0;  ///< in so many chunks
    std::uint64_t stolen = 0;  ///< of those, dealt to another device that was slower than expected, or failed
    double ms = 0.0;           ///< until its last chunk was done
};

/// Counts and times of the last call.
struct NarrowReport {
    std::uint64_t pairs = 0;     ///< candidates looked at
    std::uint64_t contacts = 0;  ///< rows of the result
    std::uint64_t tolerance_missed = 0;
    std::uint64_t warm = 0;           ///< pairs that started from what a WarmStart had kept of them
    std::uint64_t cells_skipped = 0;  ///< cells of the matrix without a pair: nothing built, allocated or launched
    std::vector<BucketReport> buckets;
    NarrowTimes ms;
    std::uint64_t peak_device_bytes = 0;
    std::vector<DeviceShare> devices;   ///< those that had a part in the call; empty where the host did it
    std::vector<std::string> warnings;  ///< a line for each device that failed and whose work was done again
};

/// Finds the contacts of candidate pairs, or which of them touch. Keeps what it sent and its buffers between calls.
/// Some hundred thousand pairs or more are shared out among the devices of the Context that give the same answers as
/// the one that does smaller calls (the same hardware under the same driver); the result is, byte for byte, that of
/// one. A device that fails is not used any more, and its part is done by others: NarrowReport::warnings.
class NarrowPhase {
public:
    /// Options out of their range are InvalidArgument. `context` must outlive this object. Builds nothing yet.
    explicit NarrowPhase(Context& context, const NarrowPhaseOptions& options = {});
    ~NarrowPhase();
    NarrowPhase(NarrowPhase&& other) noexcept;
    NarrowPhase& operator=(NarrowPhase&& other) noexcept;

    /// The contacts of those of `pairs` whose distance is at most the margins of the two bodies together, or may be
    /// within its error, in the order of `pairs`: ascending if those are; those of one pair by ascending feature. A
    /// pair of a body that is not there or rejected, of two planes, or with a mesh, is InvalidArgument. Valid until the
    /// next call or the end of this object. Throws Error; then there is no result.
    /// `warm`: what the last call has left of these pairs, and what this one leaves; it is cleared by an error. Fewer
    /// than 128 pairs, which the host does, are done without.
    View<const Contact> find(const Scene& scene, View<const Pair> pairs, WarmStart* warm = nullptr);

    /// Only which of `pairs` touch, or are within the margins of the two bodies: those of which find() has contacts,
    /// for less, as no depth, normal or point is computed; of pairs that lie within their error of the margins find()
    /// may have one and this not, or the other way round, unless both are sure. Otherwise as find(); the pairs, in
    /// order.
    View<const Pair> touching(const Scene& scene, View<const Pair> pairs, WarmStart* warm = nullptr);

    const NarrowReport& report() const noexcept;

    /// The library's own view; not for users.
    struct Impl;
    Impl& impl() const noexcept { return *impl_; }

private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace clinch
