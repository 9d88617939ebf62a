// The poses that clinch_accuracy measures on: each axis of the sweep by itself, and a mixture of all.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/truth.hpp"
#include "tests/random.hpp"

namespace clinch::accuracy {

/// How a pair is made. The first body is about 1 across.
struct Lie {
    double distance = 0;  ///< aimed at, in units of the smaller body
    double ratio = 1;     ///< the larger body to the smaller
    double aspect = 1;    ///< longest to shortest size of each body that can be flat or long
    double offset = 0;    ///< how far both are from the origin, in units of the larger
    int vertices = 12;    ///< of a hull
    double angle = -1;    ///< between the two bodies' axes; below 0: any
};

/// One value of one axis, the others as they are by default; the axes "default" and "mixture" have no value.
struct Setting {
    std::string axis;
    double value = 0;
    bool operator==(const Setting& o) const { return axis == o.axis && value == o.value; }
};

struct Sample {
    test::TruePair pair;
    Truth truth;
    double size = 0;  ///< of the pair: reaches of both and the way between
    double unit = 0;  ///< of relative distances: the smaller body's reach
};

/// The settings that make a difference to a cell. `quick`: the ends of each axis.
std::vector<Setting> settings_of(test::Kind a, test::Kind b, bool quick);
/// Of "default" the distances are a thousandth to a tenth, to both sides.
Lie lie_of(const Setting& setting, test::Random& random);
/// A pair with its true distance.
Sample sample_of(test::Kind a, test::Kind b, const Lie& lie, test::Random& random);

}  // namespace clinch::accuracy
