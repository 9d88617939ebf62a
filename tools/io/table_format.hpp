// Forms in which tables of results are written.
#pragma once

#include <string>

namespace clinch::io {

enum class TableFormat { Npy, Csv };

/// The format that a target's name asks for: .npy, .csv, or "-" for CSV on standard output. Another
/// ending is InputError.
TableFormat table_format(const std::string& path);

}  // namespace clinch::io
