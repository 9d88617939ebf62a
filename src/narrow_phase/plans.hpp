// The plans of a narrow phase's buckets, made when first asked for.
#pragma once

#include <array>
#include <cstddef>
#include <mutex>
#include <optional>

#include "clinch/narrow_phase.hpp"
#include "src/narrow_phase/cursor.hpp"
#include "src/narrow_phase/narrow_scene.hpp"

namespace clinch::detail {

/// Kept until shapes change. Several threads may ask at once.
class Plans {
public:
    /// Both must outlive this object.
    Plans(const NarrowPhaseOptions& options, const NarrowShapes& shapes) : options_(options), shapes_(shapes) {}

    /// All are made anew. Not while others ask.
    void shapes_changed() { plans_ = {}; }
    /// That of row k of the matrix, for contacts or for only which pairs touch. Stays where it is until shapes change.
    const Plan& of(std::size_t k, bool only_pairs);
    /// Where iterations in float64 may stop on the host: as a device's float64 has it.
    double host_tolerance(std::size_t k, bool only_pairs) {
        return static_cast<double>(static_cast<float>(of(k, only_pairs).tolerance64));
    }

private:
    const NarrowPhaseOptions& options_;
    const NarrowShapes& shapes_;
    std::mutex mutex_;
    std::array<std::array<std::optional<Plan>, 2>, 32> plans_;
};

}  // namespace clinch::detail
