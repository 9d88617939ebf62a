// Pairs into files.
#pragma once

#include <string>

#include "clinch/aabb.hpp"
#include "clinch/view.hpp"
#include "tools/io/output_file.hpp"

namespace clinch::io {

enum class PairFormat { Npy, Csv };

/// The format that a target's name asks for: .npy, .csv, or "-" for CSV on standard output. Another
/// ending is InputError.
PairFormat pair_format(const std::string& path);

/// Writes the pairs in their order: .npy as uint32 of shape (m, 2), .csv as a row "a,b" each below that
/// header. OutputError when the file cannot take them.
void write_pairs(OutputFile& file, PairFormat format, View<const Pair> pairs);

}  // namespace clinch::io
