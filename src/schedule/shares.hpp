// How much of a step's work each device gets, from the speeds measured in the steps before [thesis 5.1, 5.2].
#pragma once

#include <cstddef>
#include <vector>

namespace clinch::detail {

/// Fractions of the work such that all devices are expected to be done at once. Each device's time is held to be
/// seconds = latency + work * pace: both are estimated step by step from amounts that differ (a Kalman filter a
/// device), so a device that is slow to start is told from one that works slowly, and is not given less and less. One
/// thread.
///
/// A device whose latency alone is longer than the others need for everything gets nothing; it is tried again with a
/// little work after 2 steps, then after 4, 8 ... (4096 at most), until it pays.
class Shares {
public:
    /// What a device did in a step.
    struct Measure {
        double work;  ///< in a unit common to all devices of this step (it may differ between steps); 0: not measured
        double seconds;  ///< from the step's begin until its last result; else than finite and above 0: not measured
    };
    /// What is held to be true of a device.
    struct Estimate {
        double seconds_to_begin;  ///< its latency a step; 0 while nothing was measured
        double seconds_for_all;   ///< its time for the whole step's work besides; 0 while nothing was measured
    };

    /// `guesses`: the devices' speeds beside each other, in any unit. Throws Error (InvalidArgument) unless they are
    /// finite and above 0.
    explicit Shares(const std::vector<double>& guesses);

    /// What to give each device in the next step. Sum 1; 0 for retired ones (all retired: all 0).
    const std::vector<double>& fractions() const { return fractions_; }
    /// Once a step, a measure a device. Throws Error (InvalidArgument) if there are more or fewer. Those of retired
    /// devices are ignored. Cost: devices * log(devices).
    void measured(const std::vector<Measure>& measures);
    /// The device failed: it gets nothing until restored. What is known of it is kept.
    void retire(std::size_t device);
    void restore(std::size_t device);
    Estimate estimate(std::size_t device) const;

private:
    struct Device {
        double latency = 0.0;  // seconds
        double all;            // seconds for the whole work, without the latency; before any measurement in no unit
        // Variances of both and their covariance, in squared seconds.
        double latency_variance = 0.0, all_variance = 0.0, covariance = 0.0;
        bool known = false;  // measured at least once
        bool odd = false;    // the last measurement was far off what was expected, and was taken for an accident
        bool retired = false;
        bool pays = true;
        unsigned pause = 0;  // steps from its last trial to the next
        unsigned wait = 0;   // steps until the next trial: while it does not pay and this is 0, it is on trial
    };
    struct Sample {
        std::size_t device;
        double part, seconds;  // part of the whole work
    };

    std::vector<Sample> samples(const std::vector<Measure>& measures) const;
    void rescale(const std::vector<Sample>& samples);
    static void learn(Device& device, const Sample& sample);
    void learn_all(const std::vector<Sample>& samples);
    double level() const;
    void set_pauses();
    void split();

    std::vector<Device> devices_;
    std::vector<double> fractions_;
    bool measured_ = false;
};

}  // namespace clinch::detail
