// What a step did, and what it did not need to do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "clinch/scene.hpp"

namespace clinch {

/// Milliseconds of wall time a stage took. With PipelineOptions::measure_stages off, the stages that
/// a device runs behind the host's back are counted in the stage that first waits for them.
struct StageTimes {
    double total = 0.0;
    double upload = 0.0;    ///< gathering changed rows and sending them
    double bounds = 0.0;    ///< making boxes
    double broad = 0.0;     ///< finding pairs
    double narrow = 0.0;    ///< finding contacts, bringing them to the host included
    double download = 0.0;  ///< making the pairs readable on the host
};

/// Work that was not done because the scene did not need it.
struct Skipped {
    std::uint64_t bounds = 0;     ///< boxes not computed again since their rows did not change
    std::uint64_t unchanged = 0;  ///< boxes the broad phase did not look at since they did not change
    /// Boxes that changed but stayed within their fattened box: only their pairs were tested again.
    std::uint64_t inside = 0;
    std::uint64_t still = 0;  ///< bodies that cannot move whose structure was kept from the last call
    // Pairs of two bodies that cannot move are in neither count where the broad phase did not test them at all, as
    // `bvh` does among many bodies.
    // Where several devices share the work, a pair at a border may count on both sides.
    std::uint64_t pairs_filtered = 0;  ///< overlapping pairs dropped by group and mask
    std::uint64_t static_pairs = 0;    ///< overlapping pairs dropped since neither body can move
};

/// What one device did in a step that was split over several.
struct DeviceWork {
    std::size_t device = 0;   ///< its place in Context::devices()
    std::uint64_t boxes = 0;  ///< given to it; those at a border are given to the devices of both sides
    std::uint64_t pairs = 0;  ///< found by it; those at a border may be found on both sides
    double ms = 0.0;          ///< wall time of its part, kernels built in it not counted
};

/// What went from the broad to the narrow phase in a step in which both were at work at once.
struct StreamWork {
    std::uint32_t broad_devices = 0;   ///< devices that found pairs; 0: the host did
    std::uint32_t narrow_devices = 0;  ///< devices that had only contacts to find; the others did, too, when done
    std::uint64_t chunks = 0;          ///< of pairs
    std::uint64_t chunk_pairs = 0;     ///< pairs of a chunk, at most
    std::uint64_t most_waiting = 0;    ///< chunks that waited for a device at one time, at most
    std::uint64_t pair_bytes = 0;      ///< memory of the host for pairs, at most, whatever their number
};

/// Counts and times of the last step (or find).
struct Report {
    std::uint64_t bodies = 0;  ///< rejected ones included
    std::uint64_t pairs = 0;
    std::uint64_t contacts = 0;          ///< 0 where none were asked for
    std::uint64_t tolerance_missed = 0;  ///< contacts whose error is above NarrowPhaseOptions::tolerance
    std::uint64_t box_tests = 0;         ///< box against box tests done by the broad phase
    std::string algorithm;               ///< the broad phase that ran: its name in the registry, or "incremental"
    StageTimes ms;
    Skipped skipped;
    std::vector<Rejection> rejected;      ///< ascending by body
    std::vector<DeviceWork> broad_split;  ///< of each device that had a part of the broad phase; empty: one had it all
    StreamWork stream;                    ///< with PipelineOptions::streaming
    /// What went wrong and was made good: devices that failed, of which others then did the work. One line each.
    std::vector<std::string> warnings;
    std::uint64_t peak_device_bytes = 0;  ///< most memory held on devices so far, summed over them
    /// Most host memory so far of what grows with boxes and pairs and is no device's memory: lists of pairs, what is
    /// kept of them from call to call, and contacts.
    std::uint64_t peak_host_bytes = 0;
};

}  // namespace clinch
