// Pairs of simple bodies for tests, random and hostile, and what every answer has to keep.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tests/narrow_phase/closed_form_oracle.hpp"
#include "tests/random.hpp"

namespace clinch::test {

struct TruePair {
    TrueBody a, b;
};

/// A routine's answer, in double: the numbers that the contact would have.
struct Answer {
    double distance = 0, error = 0;
    std::array<double, 3> normal{}, point{};  // point: from the position of a
};

/// The pairs of classes that have a closed form, a before b.
const std::vector<std::array<Kind, 2>>& closed_form_pairs();

/// Any sizes, turns and places: flat, thin, tiny beside the other, at scales 1e-29 to 1e15, far from the world's
/// origin, near parallel to each other at angles 1e-9 to 1e-2, concentric, on each other's axes, touching up to 1e-12,
/// deep inside.
TruePair random_pair(Kind a, Kind b, Random& random);

/// Largest length of the pair: that of both bodies and of the way between them.
double size_of(const TruePair& pair);

/// What `answer` breaks of the promises in touch.clh, empty if none. `unit`: half an ulp of 1.
std::string broken_promise(const TruePair& pair, const Answer& answer, double unit);

/// The numbers that make the pair, for a failure's message.
std::string text_of(const TruePair& pair);

}  // namespace clinch::test
