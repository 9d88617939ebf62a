#include "tools/io/output_file.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <random>
#include <system_error>
#include <utility>

#include "tools/io/error.hpp"

namespace clinch::io {
namespace fs = std::filesystem;

OutputFile::OutputFile(std::string path) : path_(std::move(path)), target_(path_) {
    if (path_ == "-") {
        file_.reset(stdout);
        return;
    }
    std::error_code failure;
    const fs::file_status status = fs::status(path_, failure);
    if (status.type() == fs::file_type::directory) fail("is a folder", 0);
    if (fs::is_symlink(path_, failure)) target_ = fs::weakly_canonical(path_, failure).string();
    if (fs::exists(status) && status.type() != fs::file_type::regular) {
        file_ = open_file(path_, "wb");
        if (!file_) fail("cannot be opened for writing", errno);
    } else {
        open_beside();
    }
}

void OutputFile::open_beside() {
    // A rename would replace even a file that its owner has protected.
    std::error_code failure;
    if (fs::exists(target_, failure)) {
        file_ = open_file(target_, "r+b");
        if (!file_) fail("cannot be opened for writing", errno);
    }
    std::random_device random;
    for (int attempt = 0; attempt < 16; ++attempt) {
        std::array<char, 16> tag{};
        std::snprintf(tag.data(), tag.size(), ".%08x.part", static_cast<unsigned>(random()));
        const std::string name = target_ + tag.data();
        file_ = open_file(name, "wbx");  // x: never over a file that is there
        if (file_) {
            temporary_ = name;
            return;
        }
        if (errno != EEXIST) break;
    }
    fail("cannot be opened for writing", errno);
}

OutputFile::~OutputFile() {
    file_.reset();
    std::error_code ignored;
    if (!temporary_.empty()) fs::remove(temporary_, ignored);
}

void OutputFile::fail(const std::string& what, int error) const {
    const std::string name = path_ == "-" ? "standard output" : path_;
    throw OutputError(name + ": " + what + (error == 0 ? "" : ": " + std::generic_category().message(error)) +
                      "; a file in an existing folder that can be written is accepted");
}

void OutputFile::write(const void* data, std::size_t bytes) {
    if (bytes != 0 && std::fwrite(data, 1, bytes, file_.get()) != bytes) fail("cannot be written", errno);
}

void OutputFile::finish() {
    if (file_ && !close_file(std::move(file_))) fail("cannot be written", errno);
}

void OutputFile::commit() {
    finish();
    if (temporary_.empty()) return;
    std::error_code failure;
    const fs::file_status older = fs::status(target_, failure);
    if (fs::exists(older)) fs::permissions(temporary_, older.permissions(), failure);
    fs::rename(temporary_, target_, failure);
    if (failure) fail("the finished file cannot be given this name", failure.value());
    temporary_.clear();
}

void check_writable(const std::string& path) {
    std::error_code failure;
    const fs::file_status status = fs::status(path, failure);
    // A pipe must not be opened before there is something to say.
    if (path == "-" || (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status))) return;
    const OutputFile probe(path);
}

}  // namespace clinch::io
