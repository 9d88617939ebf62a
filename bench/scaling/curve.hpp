// What clinch_scaling measures: steps of the same work by more and more devices.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace clinch::scaling {

/// One number of devices.
struct Point {
    std::size_t devices;
    double seconds;        ///< a step, once the shares have settled; simulated the mean, real the median of several
    double ideal_seconds;  ///< if all did nothing but compute, until the last moment; real: what one takes, divided
    double stolen;         ///< part of the chunks that another device did than the one they were dealt to
};

/// One kind of work on one kind of devices.
struct Curve {
    std::string load, devices;
    double bodies;
    std::vector<Point> points;
};

/// All curves of one machine.
struct Machine {
    std::string machine;                   ///< "simulated" or "real"
    std::string name;                      ///< which machine, or which model
    std::vector<std::string> assumptions;  ///< of a simulated one: what was not measured
    std::vector<Curve> curves;
};

/// The cores of this machine's CPU as devices, up to `most`; nothing if PoCL does not offer it.
std::optional<Machine> real(std::size_t most);

/// Devices simulated by bench/machines, up to `most`. The same for the same seed.
Machine simulated(std::size_t most, unsigned long long seed);

}  // namespace clinch::scaling
