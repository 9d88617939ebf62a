// The header of an .npy file: a Python dictionary of three entries.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace clinch::io {

struct NpyHeader {
    std::string descr;  ///< NumPy's name of the element type ("<f4")
    bool fortran_order = false;
    std::vector<std::uint64_t> shape;
};

/// Reads the dictionary {'descr': '<f4', 'fortran_order': False, 'shape': (3, 6), }: exactly these three
/// keys, each once, in any order. Anything else is InputError, which begins with `where`.
NpyHeader parse_npy_header(std::string_view text, const std::string& where);

}  // namespace clinch::io
