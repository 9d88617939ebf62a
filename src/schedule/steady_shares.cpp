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

bool SteadyShares::may_stay(const std::vector<double>& dealt, const std::vector<double>& wanted) {
    constexpr double later = 1.05;
    if (dealt.size() != wanted.size()) return false;
    for (std::size_t i = 0; i < dealt.size(); ++i)
        if (dealt[i] > later * wanted[i]) return false;
    return true;
}

double SteadyShares::Paces::after(double pace) {
    last_[count_++ % last_.size()] = pace;
    return *std::min_element(last_.begin(),
                             last_.begin() + static_cast<std::ptrdiff_t>(std::min(count_, last_.size())));
}

}  // namespace clinch::detail
