// Short pieces on their way into a file.
#pragma once

#include <charconv>
#include <cstddef>
#include <cstring>
#include <string_view>
#include <vector>

#include "tools/io/output_file.hpp"

namespace clinch::io {

/// Collects pieces and writes them in blocks. finish() writes what is left.
class BlockWriter {
public:
    explicit BlockWriter(OutputFile& file) : file_(file), block_(std::size_t{1} << 16) {}

    void text(std::string_view piece) {
        if (piece.size() > block_.size() - used_) finish();
        if (piece.size() > block_.size()) {
            file_.write(piece.data(), piece.size());
            return;
        }
        if (!piece.empty()) std::memcpy(block_.data() + used_, piece.data(), piece.size());
        used_ += piece.size();
    }
    void character(char c) {
        if (used_ == block_.size()) finish();
        block_[used_++] = c;
    }
    /// A number in the fewest decimal digits that read back as the same number, to the bit.
    template <class Number>
    void number(Number value) {
        constexpr std::size_t longest = 32;
        if (longest > block_.size() - used_) finish();
        char* const at = block_.data() + used_;
        used_ += static_cast<std::size_t>(std::to_chars(at, at + longest, value).ptr - at);
    }
    /// The bytes of a value, in the order of this machine's memory.
    template <class T>
    void bytes(const T& value) {
        text({reinterpret_cast<const char*>(&value), sizeof value});
    }
    void finish() {
        file_.write(block_.data(), used_);
        used_ = 0;
    }

private:
    OutputFile& file_;
    std::vector<char> block_;
    std::size_t used_ = 0;
};

}  // namespace clinch::io
