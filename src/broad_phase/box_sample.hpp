// A few boxes of many, by which choices are made.
#pragma once

#include <cstddef>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/view.hpp"

namespace clinch::detail {

/// `size` boxes taken at random, always the same ones, some perhaps more than once; those that are no boxes left out.
std::vector<Aabb> sample_of(View<const Aabb> boxes, std::size_t size);

}  // namespace clinch::detail
