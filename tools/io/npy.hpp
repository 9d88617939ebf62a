// NumPy's .npy files: arrays of one or two dimensions, format versions 1 to 3, little-endian.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tools/io/input_file.hpp"

namespace clinch::io {

/// Types of elements that are read.
enum class NpyType { Float32, Float64, UInt8, UInt32 };

/// More bodies than this cannot be numbered: 2^32 - 1.
inline constexpr std::uint64_t max_bodies = 4294967295u;

/// An .npy file whose header has been read and checked, so that its data can be. Every fault is
/// InputError.
class NpyFile {
public:
    /// Opens an array of shape (n), if `columns` is 0, or (n, columns), of one of `types`. Checked before
    /// anything is allocated: the header, the type, the shape, n <= max_bodies, and that the file holds
    /// exactly the data that its header promises.
    NpyFile(const std::string& path, const std::vector<NpyType>& types, std::uint64_t columns);

    const std::string& path() const noexcept { return file_.path(); }
    NpyType type() const noexcept { return type_; }
    std::uint64_t rows() const noexcept { return rows_; }

    /// Copies all elements as they are, row by row whatever their order in the file, to `target`, which
    /// has room for them. Once.
    void read_rows(void* target);
    /// The same elements as numbers of type T (double for floats, std::uint32_t for whole numbers).
    template <class T>
    std::vector<T> read();

private:
    void read_header(const std::vector<NpyType>& types, std::uint64_t columns);
    [[noreturn]] void fail(const std::string& what) const;
    std::uint64_t elements() const noexcept { return rows_ * columns_; }

    InputFile file_;
    NpyType type_ = NpyType::Float32;
    std::uint64_t rows_ = 0;
    std::uint64_t columns_ = 1;
    bool by_columns_ = false;  // Fortran order
};

/// The text that stands before the data of a C-order .npy file of version 1: `descr` is NumPy's name of
/// the type ("<u4") or, of a structured array, its list of columns ("[('a', '<u4'), ...]"). Its length is a multiple
/// of 64.
std::string npy_header(std::string_view descr, const std::vector<std::uint64_t>& shape);

}  // namespace clinch::io
