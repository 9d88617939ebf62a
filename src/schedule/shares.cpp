#include "src/schedule/shares.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "clinch/error.hpp"

namespace clinch::detail {

namespace {

constexpr double noise = 0.08;            // of a measured time, one deviation
constexpr double drift = 0.02;            // of what is estimated, a step
constexpr double accident = 4.0;          // deviations: once, it is held to be an accident; twice, to be true
constexpr double marked = 1.5;            // all devices slower or faster by this factor: the work itself has changed
constexpr double least_work = 0.05;       // of a measured time is work and not latency, at least
constexpr double trial = 0.25;            // of what it would get without its latency, a device on trial is given
constexpr unsigned longest_pause = 4096;  // steps

// The value below which half of the weight lies. `values`: not empty, of value and weight.
double weighted_median(std::vector<std::pair<double, double>> values) {
    std::sort(values.begin(), values.end());
    double half = 0.0;
    for (const auto& [value, weight] : values) half += 0.5 * weight;
    for (const auto& [value, weight] : values) {
        half -= weight;
        if (half <= 0.0) return value;
    }
    return values.back().first;
}

// Whether so many devices took longer by a marked factor, or all less, that it is not they but the work: all but a
// quarter of them. What one device alone does, however large its part, is its own affair.
bool all_changed(std::vector<std::pair<double, double>> ratios) {
    std::sort(ratios.begin(), ratios.end());
    const std::size_t others = ratios.size() / 4;
    return ratios[others].first >= marked || ratios[ratios.size() - 1 - others].first <= 1.0 / marked;
}

}  // namespace

Shares::Shares(const std::vector<double>& guesses) {
    for (const double guess : guesses) {
        if (!std::isfinite(guess) || guess <= 0.0)
            throw Error(ErrorCode::InvalidArgument,
                        "the guessed speed of a device is " + std::to_string(guess) + ": must be finite and above 0");
        Device device{};
        device.all = 1.0 / guess;
        devices_.push_back(device);
    }
    split();
}

// The measures that can be used, as parts of all that was done.
std::vector<Shares::Sample> Shares::samples(const std::vector<Measure>& measures) const {
    double whole = 0.0;
    for (const Measure& measure : measures)
        if (std::isfinite(measure.work) && measure.work > 0.0) whole += measure.work;
    std::vector<Sample> found;
    if (!std::isfinite(whole)) return found;
    for (std::size_t i = 0; i < devices_.size(); ++i) {
        const double part = measures[i].work / whole, seconds = measures[i].seconds;
        if (devices_[i].retired || !(part > 0.0 && part <= 1.0) || !std::isfinite(seconds) || !(seconds > 0.0))
            continue;
        found.push_back({i, part, seconds});
    }
    return found;
}

void Shares::measured(const std::vector<Measure>& measures) {
    if (measures.size() != devices_.size())
        throw Error(ErrorCode::InvalidArgument, std::to_string(measures.size()) + " measures of " +
                                                    std::to_string(devices_.size()) + " devices: must be one each");
    const std::vector<Sample> found = samples(measures);
    if (!found.empty()) {
        rescale(found);
        learn_all(found);
        measured_ = true;
    }
    set_pauses();
    split();
}

void Shares::learn_all(const std::vector<Sample>& samples) {
    std::vector<std::pair<double, double>> changes;
    std::vector<bool> seen(devices_.size(), false);
    for (const Sample& sample : samples) {
        Device& device = devices_[sample.device];
        const double before = device.all;
        learn(device, sample);
        changes.emplace_back(device.all / before, sample.part);
        seen[sample.device] = true;
        // A trial is over; the next comes after twice the pause.
        if (!device.pays && device.wait == 0)
            device.wait = 1 + (device.pause = std::min(2 * device.pause, longest_pause));
    }
    // Those not measured change as the others do.
    const double change = weighted_median(std::move(changes));
    for (std::size_t i = 0; i < devices_.size(); ++i)
        if (!seen[i]) devices_[i].all *= change;
}

// Brings the times for the whole work to this step's amount of it, if that is markedly another; the first time always.
void Shares::rescale(const std::vector<Sample>& samples) {
    std::vector<std::pair<double, double>> ratios;
    ratios.reserve(samples.size());
    for (const Sample& sample : samples) {
        const Device& device = devices_[sample.device];
        const double work = std::max(sample.seconds - device.latency, least_work * sample.seconds);
        ratios.emplace_back(work / (sample.part * device.all), sample.part);
    }
    if (measured_ && !all_changed(ratios)) return;
    const double change = weighted_median(std::move(ratios));
    for (Device& device : devices_) {
        device.all *= change;
        device.all_variance *= change * change;
        device.covariance *= change;
    }
}

// One step of the Kalman filter with seconds = latency + part * all.
void Shares::learn(Device& device, const Sample& sample) {
    const double part = sample.part, seconds = sample.seconds;
    const double expected = device.latency + part * device.all, error = seconds - expected;
    const double random = noise * seconds;
    device.latency_variance += std::pow(drift * device.latency, 2) + std::pow(0.1 * drift * seconds, 2);
    device.all_variance += std::pow(drift * device.all, 2);
    const auto variance = [&device, part, random] {
        return device.latency_variance + 2.0 * part * device.covariance + part * part * device.all_variance +
               random * random;
    };
    const bool far = error * error > accident * accident * variance();
    if (device.known && far && !device.odd && device.pays) {
        device.odd = true;
        return;
    }
    if (!device.known || far) {  // nothing is known, or what is known is no longer true: mostly the pace is to learn
        if (!device.pays) device.latency = std::min(device.latency, 0.5 * seconds);
        device.latency_variance = std::pow(0.5 * seconds, 2);
        device.all_variance = std::pow(2.0 * std::max(device.all, seconds / part), 2);
        device.covariance = 0.0;
    }
    device.known = true;
    device.odd = false;

    const double of_latency = device.latency_variance + part * device.covariance;
    const double of_all = device.covariance + part * device.all_variance, total = variance();
    device.latency += of_latency / total * error;
    device.all += of_all / total * error;
    device.latency_variance -= of_latency * of_latency / total;
    device.all_variance -= of_all * of_all / total;
    device.covariance -= of_latency * of_all / total;

    // Neither is negative: what one must give up the other takes, as far as they depend on each other.
    const double least = least_work * seconds / part;
    if (device.all < least) {
        device.latency += device.covariance / device.all_variance * (least - device.all);
        device.all = least;
    }
    if (device.latency < 0.0) {
        device.all = std::max(least, device.all - device.covariance / device.latency_variance * device.latency);
        device.latency = 0.0;
    }
}

// The time after which all work is done when each device that begins before then works until then.
double Shares::level() const {
    std::vector<std::pair<double, double>> by_latency;
    for (const Device& device : devices_)
        if (!device.retired) by_latency.emplace_back(device.latency, 1.0 / device.all);
    std::sort(by_latency.begin(), by_latency.end());
    double time = 0.0, speed = 0.0, lost = 1.0;
    for (const auto& [latency, own_speed] : by_latency) {
        if (speed > 0.0 && latency >= time) break;
        speed += own_speed;
        lost += latency * own_speed;
        time = lost / speed;
    }
    return time;
}

// Who can not pay rests, ever longer; who pays for some time is as good as new.
void Shares::set_pauses() {
    const double time = level();
    for (Device& device : devices_) {
        if (device.retired) continue;
        if (device.wait > 0) --device.wait;
        const bool paid = device.pays;
        device.pays = device.latency < time;
        if (device.pays) {
            device.pause /= 2;
            device.wait = 0;
        } else if (paid) {
            device.wait = device.pause = std::max(device.pause, 2u);
        }
    }
}

void Shares::split() {
    const double time = level();
    fractions_.assign(devices_.size(), 0.0);
    double sum = 0.0;
    for (std::size_t i = 0; i < devices_.size(); ++i) {
        const Device& device = devices_[i];
        if (device.retired) continue;
        fractions_[i] = std::max(0.0, (time - device.latency) / device.all);
        if (!device.pays && device.wait == 0) fractions_[i] = std::max(fractions_[i], trial * time / device.all);
        sum += fractions_[i];
    }
    if (sum > 0.0)
        for (double& fraction : fractions_) fraction /= sum;
}

void Shares::retire(std::size_t device) {
    devices_.at(device).retired = true;
    split();
}

void Shares::restore(std::size_t device) {
    Device& restored = devices_.at(device);
    if (!restored.retired) return;
    restored.retired = false;
    restored.odd = true;  // it may have changed: its next measurement is believed
    restored.pays = true;
    restored.pause = restored.wait = 0;
    split();
}

Shares::Estimate Shares::estimate(std::size_t device) const {
    const Device& asked = devices_.at(device);
    if (!asked.known) return {0.0, 0.0};
    return {asked.latency, asked.all};
}

}  // namespace clinch::detail
