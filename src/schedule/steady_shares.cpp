#include "src/schedule/steady_shares.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace clinch::detail {
namespace {

// What a device gets after it had `before`, when `wanted` is best by what was measured: an amount far from all that
// were measured is a guess.
double steadied(double before, double wanted) {
    constexpr double most_change = 1.5, least = 0.02;
    if (before == 0.0) return wanted;
    const double now = std::clamp(wanted, before / most_change, before * most_change);
    return wanted == 0.0 && now < least ? 0.0 : now;
}

}  // namespace

SteadyShares::SteadyShares(const std::vector<double>& guesses)
    : shares_(guesses), given_(shares_.fractions()), paces_(guesses.size()) {}

void SteadyShares::measured(std::vector<Shares::Measure> measures) {
    for (std::size_t i = 0; i < std::min(measures.size(), paces_.size()); ++i) {
        Shares::Measure& measure = measures[i];
        const double pace = measure.seconds / measure.work;
        if (std::isfinite(pace) && pace > 0.0) measure.seconds = measure.work * paces_[i].after(pace);
    }
    shares_.measured(measures);
    for (std::size_t i = 0; i < given_.size(); ++i) given_[i] = steadied(given_[i], shares_.fractions()[i]);
}

void SteadyShares::retire(std::size_t device) {
    shares_.retire(device);
    given_[device] = 0.0;
}

// A small loss step after step is worth dealing anew once it adds up to what that costs [as renting skis until one has
// paid for them: Karlin et al., Competitive snoopy caching, 1988]; what is less than times waver is none.
bool SteadyShares::may_stay(const std::vector<double>& dealt, const std::vector<double>& wanted) {
    constexpr double most = 0.05, wavering = 0.02, price = 0.2;  // parts of a step
    double late = dealt.size() == wanted.size() ? 0.0 : 1.0;
    for (std::size_t i = 0; i < std::min(dealt.size(), wanted.size()); ++i)
        if (dealt[i] > 0.0) late = std::max(late, wanted[i] > 0.0 ? dealt[i] / wanted[i] - 1.0 : 1.0);
    lost_ += std::max(0.0, late - wavering);
    if (late <= most && lost_ < price) return true;
    lost_ = 0.0;
    return false;
}

double SteadyShares::Paces::after(double pace) {
    last_[count_++ % last_.size()] = pace;
    return *std::min_element(last_.begin(),
                             last_.begin() + static_cast<std::ptrdiff_t>(std::min(count_, last_.size())));
}

}  // namespace clinch::detail
