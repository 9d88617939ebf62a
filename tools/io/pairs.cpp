#include "tools/io/pairs.hpp"

#include <charconv>
#include <cstddef>
#include <vector>

#include "tools/io/error.hpp"
#include "tools/io/npy.hpp"
#include "tools/io/text.hpp"

namespace clinch::io {
namespace {

void write_csv(OutputFile& file, View<const Pair> pairs) {
    constexpr std::size_t longest_row = 22;  // two numbers of 10 digits, a comma, a line end
    std::vector<char> block(std::size_t{1} << 16);
    char* at = block.data();
    char* const full = block.data() + block.size() - longest_row;
    for (const char c : {'a', ',', 'b', '\n'}) *at++ = c;
    for (const Pair& pair : pairs) {
        if (at > full) {
            file.write(block.data(), static_cast<std::size_t>(at - block.data()));
            at = block.data();
        }
        at = std::to_chars(at, at + 10, pair.a).ptr;
        *at++ = ',';
        at = std::to_chars(at, at + 10, pair.b).ptr;
        *at++ = '\n';
    }
    file.write(block.data(), static_cast<std::size_t>(at - block.data()));
}

}  // namespace

PairFormat pair_format(const std::string& path) {
    if (path == "-") return PairFormat::Csv;
    const std::string end = ending(path);
    if (end == ".npy") return PairFormat::Npy;
    if (end == ".csv") return PairFormat::Csv;
    throw InputError("-o: '" + path + "' has the ending '" + end +
                     "'; .npy, .csv, or - for standard output are accepted");
}

void write_pairs(OutputFile& file, PairFormat format, View<const Pair> pairs) {
    if (format == PairFormat::Csv) {
        write_csv(file, pairs);
        return;
    }
    file.write(npy_header("<u4", {pairs.size(), 2}));
    file.write(pairs.data(), pairs.size() * sizeof(Pair));
}

}  // namespace clinch::io
