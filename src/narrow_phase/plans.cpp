#include "src/narrow_phase/plans.hpp"

namespace clinch::detail {

const Plan& Plans::of(std::size_t k, bool only_pairs) {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::optional<Plan>& plan = plans_[k][only_pairs ? 1 : 0];
    if (plan) return *plan;
    NarrowPhaseOptions wanted = options_;
    if (only_pairs) wanted.tolerance.reset();
    const MatrixRow& row = matrix()[k];
    plan = plan_of(row, wanted, wanted.tolerance ? largest_pair(shapes_, row) : 1.0);
    return *plan;
}

}  // namespace clinch::detail
