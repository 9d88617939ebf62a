// What clinch_accuracy writes: JSON, the table that the library is built with, and a summary to read.
#pragma once

#include <iosfwd>
#include <nlohmann/json.hpp>
#include <vector>

#include "bench/accuracy/measure.hpp"

namespace clinch::accuracy {

/// "sphere-box"
std::string classes_of(const CellResult& cell);

/// Everything that was measured; docs/accuracy.md says what the keys mean.
nlohmann::json json_of(const std::vector<CellResult>& cells, const Options& options, const std::string& device);

/// Rows of src/narrow_phase/measured.inc.
void write_table(const std::vector<CellResult>& cells, std::ostream& out);

/// A Markdown table, a row a cell.
void write_summary(const std::vector<CellResult>& cells, std::ostream& out);

/// Promises broken, answers that are not numbers, and references that contradict each other, of all.
std::size_t faults(const std::vector<CellResult>& cells);

}  // namespace clinch::accuracy
