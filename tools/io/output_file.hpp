// A file that appears under its name only when it is complete.
#pragma once

#include <cstddef>
#include <string>

#include "tools/io/file_pointer.hpp"

namespace clinch::io {

/// Bytes on their way to a target. A regular file is written beside its target under another name and
/// renamed by commit(); without that the target stays as it was and nothing is left behind. A link is
/// followed, an older file keeps its permissions; a pipe or device is written directly, as is standard output, whose
/// name is "-". All failures are OutputError.
class OutputFile {
public:
    explicit OutputFile(std::string path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    const std::string& path() const noexcept { return path_; }
    void write(const void* data, std::size_t bytes);
    void write(const std::string& text) { write(text.data(), text.size()); }
    /// Hands every byte to the system, so that after it only the rename can fail.
    void finish();
    /// finish(), then the target's name names the new content.
    void commit();

private:
    void open_beside();
    [[noreturn]] void fail(const std::string& what, int error) const;

    std::string path_;       // as the user named it
    std::string target_;     // links followed
    std::string temporary_;  // empty: written directly
    FilePointer file_;
};

/// Checks that `path` could be written now, so that long work need not be done in vain: makes and
/// removes an OutputFile.
void check_writable(const std::string& path);

}  // namespace clinch::io
