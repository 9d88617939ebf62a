#include "bench/scenes/motion.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bench/scenes/random.hpp"
#include "clinch/error.hpp"

namespace clinch::scenes {

SparseMotion::SparseMotion(std::vector<Aabb> boxes, double fraction, std::uint64_t seed) : boxes_(std::move(boxes)) {
    if (!(fraction >= 0.0 && fraction <= 1.0))
        throw Error(ErrorCode::InvalidArgument,
                    "the fraction of moving boxes is " + std::to_string(fraction) + "; 0 to 1 is accepted");
    const auto wanted = static_cast<std::size_t>(std::llround(fraction * static_cast<double>(boxes_.size())));
    movers_.reserve(wanted);
    states_.reserve(wanted);
    Random random(seed);
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
        Mover mover{};
        for (std::size_t d = 0; d < 3; ++d) {
            mover.centre[d] = 0.5 * (double{boxes_[i].min[d]} + double{boxes_[i].max[d]});
            mover.half[d] = 0.5 * (double{boxes_[i].max[d]} - double{boxes_[i].min[d]});
            low_[d] = i == 0 ? mover.centre[d] : std::min(low_[d], mover.centre[d]);
            high_[d] = i == 0 ? mover.centre[d] : std::max(high_[d], mover.centre[d]);
        }
        // Selection sampling: each box with the chance that leaves the right number in the end.
        if (random.below(boxes_.size() - i) >= wanted - movers_.size()) continue;
        const Vector direction = random.direction();
        for (std::size_t d = 0; d < 3; ++d) mover.step[d] = 0.02 * mover.half[d] * direction[d];
        movers_.push_back(static_cast<std::uint32_t>(i));
        states_.push_back(mover);
    }
}

void SparseMotion::step() {
    for (std::size_t k = 0; k < movers_.size(); ++k) {
        Mover& mover = states_[k];
        Aabb& box = boxes_[movers_[k]];
        for (std::size_t d = 0; d < 3; ++d) {
            const double ahead = mover.centre[d] + mover.step[d];
            if (ahead < low_[d] || ahead > high_[d]) mover.step[d] = -mover.step[d];
            mover.centre[d] += mover.step[d];
            box.min[d] = static_cast<float>(mover.centre[d] - mover.half[d]);
            box.max[d] = static_cast<float>(mover.centre[d] + mover.half[d]);
        }
    }
}

}  // namespace clinch::scenes
