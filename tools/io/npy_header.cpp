#include "tools/io/npy_header.hpp"

#include <charconv>
#include <system_error>

#include "tools/io/error.hpp"

namespace clinch::io {
namespace {

/// Reads the few forms of Python literal that a header is made of.
class Parser {
public:
    Parser(std::string_view text, const std::string& where) : text_(text), where_(where) {}

    NpyHeader dictionary() {
        NpyHeader header;
        bool has_descr = false, has_order = false, has_shape = false;
        expect('{', "a dictionary");
        while (!take('}')) {
            const std::string key = quoted("a key");
            bool* const seen = key == "descr"           ? &has_descr
                               : key == "fortran_order" ? &has_order
                               : key == "shape"         ? &has_shape
                                                        : nullptr;
            if (seen == nullptr) fail("has the key '" + key + "'; descr, fortran_order and shape are accepted");
            if (*seen) fail("has the key '" + key + "' twice; once is accepted");
            *seen = true;
            expect(':', "a value after each key");
            if (seen == &has_descr) header.descr = descr();
            if (seen == &has_order) header.fortran_order = boolean();
            if (seen == &has_shape) header.shape = tuple();
            if (!take(',') && peek() != '}') fail("lacks a comma or '}' after the value of '" + key + "'");
        }
        skip_space();
        if (at_ < text_.size()) fail("goes on after its dictionary; only spaces are accepted there");
        if (!has_descr || !has_order || !has_shape) fail("lacks one of the keys descr, fortran_order and shape");
        return header;
    }

private:
    [[noreturn]] void fail(const std::string& what) const { throw InputError(where_ + ": the header " + what); }

    void skip_space() {
        while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n')) ++at_;
    }
    char peek() {
        skip_space();
        return at_ < text_.size() ? text_[at_] : '\0';
    }
    bool take(char c) {
        if (peek() != c) return false;
        ++at_;
        return true;
    }
    void expect(char c, const char* what) {
        if (!take(c)) fail(std::string("lacks '") + c + "' where " + what + " should stand");
    }

    std::string quoted(const char* what) {
        const char quote = peek();
        const std::size_t end = quote == '\'' || quote == '"' ? text_.find(quote, at_ + 1) : std::string_view::npos;
        if (end == std::string_view::npos) fail(std::string("lacks a quoted text where ") + what + " should stand");
        const std::string_view word = text_.substr(at_ + 1, end - at_ - 1);
        at_ = end + 1;
        return std::string(word);
    }

    std::string descr() {
        if (peek() == '[') fail("describes a structured type; plain numbers are accepted");
        return quoted("the type");
    }

    bool boolean() {
        skip_space();
        for (const std::string_view word : {std::string_view("True"), std::string_view("False")})
            if (text_.substr(at_, word.size()) == word) {
                at_ += word.size();
                return word == "True";
            }
        fail("has a fortran_order that is neither True nor False");
    }

    std::vector<std::uint64_t> tuple() {
        std::vector<std::uint64_t> sizes;
        expect('(', "the shape");
        while (!take(')')) {
            sizes.push_back(whole());
            const bool comma = take(',');
            if (!comma && peek() != ')') fail("has a shape without a comma or ')' after a size");
            if (!comma && sizes.size() == 1) fail("has a shape that is no tuple, as (5) for (5,)");
        }
        return sizes;
    }

    std::uint64_t whole() {
        skip_space();
        std::uint64_t size = 0;
        const auto result = std::from_chars(text_.data() + at_, text_.data() + text_.size(), size);
        if (result.ec == std::errc::result_out_of_range) fail("has a size in its shape that passes 2^64 - 1");
        if (result.ec != std::errc()) fail("has a size in its shape that is no whole number >= 0");
        at_ = static_cast<std::size_t>(result.ptr - text_.data());
        return size;
    }

    std::string_view text_;
    const std::string& where_;
    std::size_t at_ = 0;
};

}  // namespace

NpyHeader parse_npy_header(std::string_view text, const std::string& where) {
    return Parser(text, where).dictionary();
}

}  // namespace clinch::io
