// Boxes out of and into .npy files.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/scene.hpp"

namespace clinch::io {

struct BoxFile {
    std::vector<Aabb> boxes;          ///< one a row of the file, rejected ones included
    std::vector<Rejection> rejected;  ///< meaningless rows with the reason, ascending; their boxes are NaN throughout
};

/// Reads an array of shape (n, 6): min x y z, max x y z of one box a row, float32 as it is or float64
/// rounded outward to float32 (only where float32 does not hold the number). A row with NaN, an
/// infinite number, min > max or a number beyond float32's range is rejected. InputError as NpyFile.
BoxFile read_boxes(const std::string& path);

/// Why a row, min x y z and max x y z, is rejected, as one clause ("min y is nan and must be finite"), or nothing.
std::string why_no_box(const std::array<float, 6>& min_max);
std::string why_no_box(const std::array<double, 6>& min_max);

/// The smallest box of float32 numbers that holds the given one: min x y z, max x y z, finite and
/// within float32's range.
Aabb round_outward(const std::array<double, 6>& min_max);

}  // namespace clinch::io
