#include "tools/io/input_file.hpp"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <utility>

#include "tools/io/error.hpp"

namespace clinch::io {

InputFile::InputFile(std::string path) : path_(std::move(path)) {
    std::error_code failure;
    const std::filesystem::file_status status = std::filesystem::status(path_, failure);
    if (status.type() == std::filesystem::file_type::not_found)
        throw InputError(path_ + ": there is no such file; an existing file is accepted");
    if (failure) throw InputError(path_ + ": cannot be looked at: " + failure.message());
    if (status.type() != std::filesystem::file_type::regular)
        throw InputError(path_ + ": is no regular file; only those are accepted");
    size_ = std::filesystem::file_size(path_, failure);
    if (failure) throw InputError(path_ + ": its size cannot be read: " + failure.message());
    file_ = open_file(path_, "rb");
    if (!file_) throw InputError(path_ + ": cannot be opened for reading: " + std::generic_category().message(errno));
}

void InputFile::read(void* target, std::size_t bytes) {
    if (bytes == 0 || std::fread(target, 1, bytes, file_.get()) == bytes) return;
    if (std::ferror(file_.get()) != 0)
        throw InputError(path_ + ": cannot be read: " + std::generic_category().message(errno));
    throw InputError(path_ + ": ends too early: " + std::to_string(bytes) + " more bytes are needed");
}

std::string read_text(const std::string& path) {
    InputFile file(path);
    std::string text(file.size(), '\0');
    file.read(text.data(), text.size());
    return text;
}

}  // namespace clinch::io
