#include "src/schedule/phase_balance.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "clinch/error.hpp"

namespace clinch::detail {

namespace {

constexpr double marked = 0.1;           // a change of work or size, as a part of what it was
constexpr double slight = 0.04;          // from check to check: things are still moving
constexpr double sudden = 0.3;           // a measurement so far off begins anew
constexpr double gain = 0.04;            // a move must promise at least this part of the step's time
constexpr double gain_of_known = 0.08;   // a move back to a split that was measured before
constexpr double newest = 0.5;           // weight of the newest measurement for a phase's time
constexpr double newest_of_trend = 0.2;  // and for its trend
constexpr double trust = 0.1;            // squared log of the change of units that teaches half of what it seems to
constexpr unsigned averaged = 8;         // measurements of a split that its time is averaged over

bool differs(double now, double then, double part) {
    return std::abs(now - then) > part * then;
}

}  // namespace

PhaseBalance::PhaseBalance(unsigned units, unsigned broad_units, unsigned longest_interval)
    : units_(units), broad_units_(broad_units == 0 ? units / 2 : broad_units), longest_(longest_interval) {
    if (units < 2 || broad_units_ >= units)
        throw Error(ErrorCode::InvalidArgument, std::to_string(broad_units) + " of " + std::to_string(units) +
                                                    " units for the broad phase: each phase must have at least one");
    if (longest_interval == 0)
        throw Error(ErrorCode::InvalidArgument, "the longest interval of checks is 0 steps: must be at least 1");
    known_.resize(units);
}

void PhaseBalance::Phase::scale(double factor) {
    for (double* seconds : {&now, &a_step, &at_change, &at_check}) *seconds *= factor;
}

// After a move: what of the difference to the promise is due to the exponent. The factor by which what was promised
// must be corrected for it.
double PhaseBalance::Phase::learn_exponent(double measured, unsigned steps) {
    const double expected = now + a_step * steps, change = moved;
    moved = 0.0;
    if (change == 0.0 || !(expected > 0.0) || !(measured > 0.0)) return 1.0;
    const double seems = exponent - std::log(measured / expected) / change;
    const double learnt =
        std::clamp(exponent + (seems - exponent) * change * change / (change * change + trust), 0.1, 1.2);
    const double factor = std::exp((exponent - learnt) * change);
    exponent = learnt;
    scale(factor);
    return factor;
}

// `steps` after the last measurement.
void PhaseBalance::Phase::follow(double measured, unsigned steps) {
    const double expected = std::max(0.0, now + a_step * steps), error = measured - expected;
    if (differs(measured, expected, sudden)) {
        now = measured;
        a_step = 0.0;
    } else {
        now = expected + newest * error;
        a_step += newest_of_trend * error / steps;
    }
}

// Seconds of the next step if it has `then_units`.
double PhaseBalance::Phase::with(unsigned now_units, unsigned then_units) const {
    const double next = std::clamp(now + a_step, (1.0 - sudden) * now, (1.0 + sudden) * now);
    return next * std::pow(static_cast<double>(now_units) / then_units, exponent);
}

// What was found out about the splits no longer holds.
void PhaseBalance::changed() {
    std::fill(known_.begin(), known_.end(), Known{});
    interval_ = 1;
    countdown_ = 0;
}

void PhaseBalance::scene_size(std::uint64_t bodies) {
    if (!differs(static_cast<double>(bodies), static_cast<double>(bodies_), marked)) return;
    bodies_ = bodies;
    changed();
}

void PhaseBalance::passed() {
    if (countdown_ > 0) --countdown_;
    ++unmeasured_;
}

void PhaseBalance::measured(Times times) {
    const bool possible = std::isfinite(times.broad) && std::isfinite(times.narrow) && times.broad >= 0.0 &&
                          times.narrow >= 0.0 && times.broad + times.narrow > 0.0;
    if (!possible) return passed();
    const double broad_factor = broad_.learn_exponent(times.broad, unmeasured_ + 1);
    const double narrow_factor = narrow_.learn_exponent(times.narrow, unmeasured_ + 1);
    for (Known& known : known_) {
        known.broad *= broad_factor;
        known.narrow *= narrow_factor;
    }
    broad_.follow(times.broad, unmeasured_ + 1);
    narrow_.follow(times.narrow, unmeasured_ + 1);
    unmeasured_ = 0;
    const bool left = differs(broad_.now, broad_.at_change, marked) || differs(narrow_.now, narrow_.at_change, marked);
    if (left && !fresh_) changed();
    for (Phase* phase : {&broad_, &narrow_})
        if (left) phase->at_change = phase->now;
    fresh_ = false;
    Known& here = known_[broad_units_];
    here.count = holds(here) ? std::min(here.count + 1, averaged) : 1;
    here.seconds += (std::max(times.broad, times.narrow) - here.seconds) / here.count;
    here.broad = broad_.now;
    here.narrow = narrow_.now;
    if (countdown_ > 0)
        --countdown_;
    else
        check();
}

// Whether the phases' work is what it was when this was measured.
bool PhaseBalance::holds(const Known& known) const {
    return known.count > 0 && !differs(broad_.now, known.broad, marked) && !differs(narrow_.now, known.narrow, marked);
}

double PhaseBalance::promised(unsigned broad) const {
    return std::max(broad_.with(broad_units_, broad), narrow_.with(narrow_units(), units_ - broad));
}

void PhaseBalance::check() {
    const double here = promised(broad_units_);
    double least = here;
    unsigned best = broad_units_;
    for (unsigned broad = 1; broad < units_; ++broad) {
        const bool known = holds(known_[broad]);
        const double there = known ? known_[broad].seconds : promised(broad);
        if (there >= least || there > (1.0 - (known ? gain_of_known : gain)) * here) continue;
        least = there;
        best = broad;
    }
    const bool moving = differs(broad_.now, broad_.at_check, slight) || differs(narrow_.now, narrow_.at_check, slight);
    for (Phase* phase : {&broad_, &narrow_}) phase->at_check = phase->now;
    if (best != broad_units_) {
        move(best);
        interval_ = 1;
    } else if (!moving) {
        interval_ = std::min(2 * interval_, longest_);
    }
    countdown_ = interval_ - 1;
}

// All that is kept of the phases' times is from now on told for the new split.
void PhaseBalance::move(unsigned broad) {
    broad_.moved = std::log(static_cast<double>(broad) / broad_units());
    narrow_.moved = std::log(static_cast<double>(units_ - broad) / narrow_units());
    const double broad_factor = std::exp(-broad_.exponent * broad_.moved);
    const double narrow_factor = std::exp(-narrow_.exponent * narrow_.moved);
    broad_.scale(broad_factor);
    narrow_.scale(narrow_factor);
    for (Known& known : known_) {
        known.broad *= broad_factor;
        known.narrow *= narrow_factor;
    }
    broad_units_ = broad;
    ++moves_;
}

}  // namespace clinch::detail
