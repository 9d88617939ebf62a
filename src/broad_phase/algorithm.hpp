// What every broad-phase algorithm offers, and the table of all of them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "clinch/broad_phase.hpp"
#include "clinch/view.hpp"
#include "src/broad_phase/inputs.hpp"
#include "src/broad_phase/pair_list.hpp"
#include "src/device/device.hpp"

namespace clinch::detail {

/// Counts that an algorithm keeps.
struct FindCounts {
    std::uint64_t box_tests = 0;
    std::uint64_t pairs_filtered = 0;
    std::uint64_t static_pairs = 0;
    std::uint64_t still = 0;         ///< bodies that cannot move whose structure was kept from the last call
    std::uint64_t boxes_inside = 0;  ///< changed boxes that stayed within their fattened box
    double download_ms = 0.0;        ///< spent making pairs readable on the host
    bool named = false;              ///< pairs are of names, see BoxInput::name
    bool invalid_boxes = false;      ///< it met boxes that are no boxes; which, the caller finds out
};

/// One algorithm with the buffers it keeps between calls.
class BroadPhaseAlgorithm {
public:
    virtual ~BroadPhaseAlgorithm() = default;
    /// Puts all pairs that pass into `pairs` (empty on entry), in the order the options ask for, and
    /// adds to `counts`. Throws LimitExceeded through check_limit().
    virtual void find(BoxInput& boxes, const FilterInput& filters, PairList& pairs, FindCounts& counts) = 0;
};

/// One row of the registry.
struct AlgorithmRow {
    const char* name;
    bool needs_device;
    bool long_loops;  ///< does not run on a device with the quirk loops-end-early
    bool in_range;    ///< finds no pairs but those of BoxInput::wanted()
    /// `device` is null for a row that needs none.
    std::unique_ptr<BroadPhaseAlgorithm> (*make)(Device* device, const BroadPhaseOptions& options);
};

/// All algorithms. A new one is one file with a maker declared in registry.cpp and one row there.
View<const AlgorithmRow> registry();
/// The row of `name`; an unknown name is InvalidArgument that lists the known ones.
const AlgorithmRow& algorithm_named(const std::string& name);
/// The choice of "auto" for `count` boxes, among which the last call found `last_pairs`; `device` is the one to work
/// on, null for the host alone; `boxes` are they if they are in host memory, else empty. Looks at 64 of them at most:
/// some microseconds.
const AlgorithmRow& choose_algorithm(std::uint64_t count, std::uint64_t last_pairs, const DeviceInfo* device,
                                     View<const Aabb> boxes = {});
/// Whether the algorithm gives right results on the device.
bool runs_on(const AlgorithmRow& row, const DeviceInfo& device);

/// Throws LimitExceeded when `pairs` is more than the options allow; `pairs` is the true count.
void check_limit(std::uint64_t pairs, const BroadPhaseOptions& options);

}  // namespace clinch::detail
