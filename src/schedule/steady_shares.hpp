// Shares of work that stays where it was dealt from step to step: measured times waver, and dealing anew costs.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "src/schedule/shares.hpp"

namespace clinch::detail {

/// Shares by the best that each device did of late, changed little by little. One thread.
class SteadyShares {
public:
    /// As Shares.
    explicit SteadyShares(const std::vector<double>& guesses);

    /// What to give each device, beside the others; 0: nothing. The sum is near 1.
    const std::vector<double>& fractions() const noexcept { return given_; }
    /// Once a step, a measure a device, as Shares::measured().
    void measured(std::vector<Shares::Measure> measures);
    /// As Shares::retire().
    void retire(std::size_t device);
    /// Once a step: whether work that was dealt by the fractions `dealt` (sum 1) may stay so when it should be dealt by
    /// `wanted` (sum 1): no device would be done later than is best by more than a twentieth, and what was lost that
    /// way since it was dealt is not worth dealing it anew.
    bool may_stay(const std::vector<double>& dealt, const std::vector<double>& wanted);

private:
    // Seconds for a unit of work in the last steps.
    class Paces {
    public:
        /// The least of the last ones, with this one. What makes a step longer than it need be passes: fresh memory in
        /// the first step and where a share grew, another program. Four: that a device became slower is known so late.
        double after(double pace);

    private:
        std::array<double, 4> last_{};
        std::size_t count_ = 0;
    };
    Shares shares_;
    std::vector<double> given_;
    std::vector<Paces> paces_;
    double lost_ = 0.0;  // steps, since work was dealt
};

}  // namespace clinch::detail
