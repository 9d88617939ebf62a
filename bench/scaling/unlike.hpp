// Two devices of which one is made four times as slow: how soon, and how well, they share a step.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace clinch::scaling {

/// One step of both devices, the quick one first.
struct UnlikeStep {
    double seconds;
    std::array<double, 2> shares;          ///< parts of the boxes or pairs that each did
    std::array<double, 2> device_seconds;  ///< that each took for them
};

/// One kind of work.
struct UnlikeCurve {
    std::string load;
    double bodies;
    std::array<double, 2> alone_seconds;  ///< a step of one device without the other: a median, kernels there
    double ideal_seconds;                 ///< 1 / (1 / first + 1 / second) of those
    std::vector<UnlikeStep> steps;        ///< from the first on, of which nothing was known; kernels were there
};

/// A core of this machine's CPU, and PoCL's device `basic` (else a second core) slowed to a quarter. Nothing if there
/// are no two such devices. Takes some minutes.
std::vector<UnlikeCurve> unlike();

/// As a table: of each step how far time and shares are from the ideal ones.
std::string table(const std::vector<UnlikeCurve>& curves);

}  // namespace clinch::scaling
