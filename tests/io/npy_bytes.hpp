// .npy files byte by byte, made without the code that is tested.
#pragma once

#include <cstring>
#include <string>
#include <vector>

namespace clinch::test {

/// Magic, version, length and this header text as it is, then the data.
inline std::string npy_raw(const std::string& header, const std::string& data, int version = 1) {
    std::string file = "\x93NUMPY";
    file += static_cast<char>(version);
    file += '\0';
    for (int byte = 0; byte < (version == 1 ? 2 : 4); ++byte)
        file += static_cast<char>(header.size() >> (8 * byte) & 0xff);
    return file + header + data;
}

/// As NumPy writes: `shape` is Python text, "(2, 6)".
inline std::string npy(const std::string& descr, const std::string& shape, const std::string& data, int version = 1,
                       bool fortran = false) {
    std::string header =
        "{'descr': '" + descr + "', 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': " + shape + ", }";
    while ((header.size() + (version == 1 ? 10 : 12) + 1) % 64 != 0) header += ' ';
    return npy_raw(header + '\n', data, version);
}

/// The bytes of some numbers.
template <class T>
std::string bytes(const std::vector<T>& numbers) {
    std::string text(numbers.size() * sizeof(T), '\0');
    if (!numbers.empty()) std::memcpy(text.data(), numbers.data(), text.size());
    return text;
}

}  // namespace clinch::test
