// Right or wrong, and by how much.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/peers/narrow/batch.hpp"
#include "bench/peers/narrow/peer.hpp"

namespace clinch::peers::narrow {

/// Off by more than this share of a pair's size is wrong; bodies whose true distance is within it may be called
/// touching or not.
constexpr double right_within = 1e-3;

/// Counts are of pairs; what is `worst` is a share of the pair's size.
struct Verdict {
    std::uint64_t missing = 0;         ///< no answer at all
    std::uint64_t wrong_touching = 0;  ///< touching called apart, or the other way round
    std::uint64_t wrong_distance = 0;  ///< off by more than right_within
    double worst_distance = 0.0;       ///< |distance - true distance|
    /// How much less than the true distance the bodies are apart along the answer's normal (deeper, if they overlap):
    /// what a push along it would be off by.
    double worst_normal = 0.0;
    std::uint64_t wrong_normal = 0;  ///< by more than right_within
    /// Contact: how far the point is outside of the slab, across the true normal, that both bodies share. Distance: how
    /// far the two points are from the bodies' highest and lowest along the normal.
    double worst_point = 0.0;
    std::uint64_t wrong_point = 0;  ///< by more than right_within

    std::uint64_t wrong() const { return missing + wrong_touching + wrong_distance; }
};

Verdict judge(const Batch& batch, Question question, const std::vector<Answer>& answers);

}  // namespace clinch::peers::narrow
