// Pairs into files.
#pragma once

#include "clinch/aabb.hpp"
#include "clinch/view.hpp"
#include "tools/io/output_file.hpp"
#include "tools/io/table_format.hpp"

namespace clinch::io {

/// Writes the pairs in their order: .npy as uint32 of shape (m, 2), .csv as a row "a,b" each below that
/// header. OutputError when the file cannot take them.
void write_pairs(OutputFile& file, TableFormat format, View<const Pair> pairs);

}  // namespace clinch::io
