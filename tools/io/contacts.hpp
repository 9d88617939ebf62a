// Contacts into files.
#pragma once

#include "clinch/contact.hpp"
#include "clinch/view.hpp"
#include "tools/io/output_file.hpp"
#include "tools/io/table_format.hpp"

namespace clinch::io {

/// Writes the contacts in their order, a row each, with the columns a, b, ax, ay, az, bx, by, bz, nx, ny, nz, distance,
/// error, feature: .npy as a structured array of shape (m), a, b and feature uint32, the others float64, without
/// padding; .csv below a header of those names, in numbers that read back to the same bits. OutputError when the file
/// cannot take them.
void write_contacts(OutputFile& file, TableFormat format, View<const Contact> contacts);

}  // namespace clinch::io
