// A C stream that closes itself: the one place where files are opened and closed.
#pragma once

#include <cstdio>
#include <memory>
#include <string>

namespace clinch::io {

/// Closes a stream, but not standard output, which the program does not own.
struct CloseFile {
    void operator()(std::FILE* file) const noexcept {
        if (file != stdout) std::fclose(file);  // NOLINT(cppcoreguidelines-owning-memory)
    }
};
using FilePointer = std::unique_ptr<std::FILE, CloseFile>;

/// As std::fopen: null, with errno set, if it fails.
inline FilePointer open_file(const std::string& path, const char* mode) {
    return FilePointer(std::fopen(path.c_str(), mode));  // NOLINT(cppcoreguidelines-owning-memory)
}

/// Closes a stream with the last of its bytes; false, with errno set, if they could not be written.
inline bool close_file(FilePointer file) {
    return file.get() == stdout ? std::fflush(stdout) == 0
                                : std::fclose(file.release()) == 0;  // NOLINT(cppcoreguidelines-owning-memory)
}

}  // namespace clinch::io
