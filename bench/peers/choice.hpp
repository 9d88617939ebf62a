// The automatic choice beside all that could have been chosen, on every kind of scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bench/peers/measure.hpp"

namespace clinch::peers {

struct ChoiceScenes {
    std::vector<std::string> kinds;   ///< all for none
    std::vector<std::size_t> counts;  ///< ascending
    std::uint64_t seed = 1;
};

/// Times `auto`, each of clinch's own algorithms and the libraries among `rows` on each of `scenes`, pairs in any
/// order, and prints a row of Markdown a scene as it is done, with those of more than 1e8 pairs as left out. Beyond
/// 10,000 boxes what tests all pairs, or takes as long, does not run, nor do peers that are expected to take longer
/// than `rules.most_seconds`, going by the next smaller scene of the kind. Calls `done` with the outcome of each scene.
void measure_choice(const std::vector<PeerRow>& rows, const ChoiceScenes& scenes, const Rules& rules,
                    const std::function<void(const Outcome&)>& done);

}  // namespace clinch::peers
