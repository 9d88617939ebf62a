// A file read from front to back, with the checks that every format needs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "tools/io/file_pointer.hpp"

namespace clinch::io {

/// A regular file opened for reading; closed at its end.
class InputFile {
public:
    /// A file that is missing, no regular file, or unreadable is InputError.
    explicit InputFile(std::string path);

    const std::string& path() const noexcept { return path_; }
    /// Length in bytes when it was opened.
    std::uint64_t size() const noexcept { return size_; }
    /// The next `bytes` bytes; fewer than that left is InputError.
    void read(void* target, std::size_t bytes);

private:
    std::string path_;
    std::uint64_t size_ = 0;
    FilePointer file_;
};

/// The whole content of a file. Errors as InputFile.
std::string read_text(const std::string& path);

}  // namespace clinch::io
