// The true distance of a pair, by ways that the routines do not go.
#pragma once

#include <string>

#include "bench/accuracy/difference_hull.hpp"

namespace clinch::accuracy {

enum class Source {
    closed_form,  ///< tests/narrow_phase/closed_form_oracle.hpp, in 113 bits
    enumeration,  ///< tests/narrow_phase/polytope_oracle.hpp: every axis and every pair of features, in 64 bits
    search        ///< difference_hull.hpp, in 64 bits
};
std::string text_of(Source source);

/// The distance is in [low, high]. Errors are counted against `low`: the greatest separation that was found.
struct Truth {
    Real low = 0, high = 0;
    Source source = Source::closed_form;
    bool agrees = true;  ///< a second reference, where there is one, found the same to within `agreement` of the size
};

/// Thin facets of the search are no better, between bodies of very unlike sizes.
constexpr Real agreement = 1e-13L;

/// Closed forms where there are any; enumeration of polytopes of up to 24 vertices that are not all but parallel; else
/// the search.
Truth truth_of(const test::TruePair& pair, bool nearly_parallel);

/// Whether bounds_of() can tell about such a pair.
bool has_volume(test::Kind a, test::Kind b);

/// By how much the separation along `normal` falls short of the true distance. Of a plane: how far the normal is off
/// its own, times the pair's size.
double regret(const test::TruePair& pair, const Truth& truth, const std::array<double, 3>& normal);

}  // namespace clinch::accuracy
