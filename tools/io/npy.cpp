#include "tools/io/npy.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "tools/io/error.hpp"
#include "tools/io/npy_header.hpp"
#include "tools/io/text.hpp"

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "elements are read and written as they lie in memory, which must be little-endian"
#endif

namespace clinch::io {
namespace {

constexpr std::string_view magic{"\x93NUMPY", 6};

struct TypeRow {
    NpyType type;
    const char* name;
    std::size_t bytes;
    std::array<const char*, 3> descrs;  // spellings that mean it
};

constexpr std::array<TypeRow, 4> type_rows{{
    {NpyType::Float32, "float32", 4, {"<f4", "<f4", "<f4"}},
    {NpyType::Float64, "float64", 8, {"<f8", "<f8", "<f8"}},
    {NpyType::UInt8, "uint8", 1, {"|u1", "<u1", "u1"}},
    {NpyType::UInt32, "uint32", 4, {"<u4", "<u4", "<u4"}},
}};

const TypeRow& row_of(NpyType type) {
    return type_rows[static_cast<std::size_t>(type)];
}

std::string shape_text(const std::vector<std::uint64_t>& shape) {
    std::string text = "(";
    for (std::size_t i = 0; i < shape.size(); ++i) text += (i == 0 ? "" : ", ") + std::to_string(shape[i]);
    return text + (shape.size() == 1 ? ",)" : ")");
}

/// What a foreign type's letter says, for the message.
std::string type_text(const std::string& descr) {
    const std::string found = "'" + descr + "'";
    return !descr.empty() && descr[0] == '>' ? found + ", big-endian" : found;
}

}  // namespace

NpyFile::NpyFile(const std::string& path, const std::vector<NpyType>& types, std::uint64_t columns) : file_(path) {
    read_header(types, columns);
}

void NpyFile::fail(const std::string& what) const {
    throw InputError(path() + ": " + what);
}

void NpyFile::read_header(const std::vector<NpyType>& types, std::uint64_t columns) {
    std::array<char, 8> start{};
    if (file_.size() < start.size()) fail("is too short for an .npy file: " + std::to_string(file_.size()) + " bytes");
    file_.read(start.data(), start.size());
    if (std::string_view(start.data(), magic.size()) != magic) fail("does not begin as an .npy file does");
    const int version = static_cast<unsigned char>(start[6]), minor = static_cast<unsigned char>(start[7]);
    if (version < 1 || version > 3 || minor != 0)
        fail("has format version " + std::to_string(version) + "." + std::to_string(minor) +
             "; 1.0, 2.0 and 3.0 are accepted");

    std::array<unsigned char, 4> length{};
    const std::size_t length_bytes = version == 1 ? 2 : 4;
    if (file_.size() - start.size() < length_bytes) fail("is truncated: it ends within its header");
    file_.read(length.data(), length_bytes);
    std::uint32_t header_bytes = 0;
    std::memcpy(&header_bytes, length.data(), sizeof header_bytes);
    const std::uint64_t data_start = start.size() + length_bytes + header_bytes;
    if (file_.size() < data_start)
        fail("is truncated: its header has " + std::to_string(header_bytes) + " bytes and the file ends within it");
    std::string text(header_bytes, '\0');
    file_.read(text.data(), text.size());
    const NpyHeader header = parse_npy_header(text, path());

    std::vector<std::string> accepted;
    const TypeRow* found = nullptr;
    for (const NpyType type : types) {
        const TypeRow& row = row_of(type);
        accepted.emplace_back(row.name);
        if (std::find(row.descrs.begin(), row.descrs.end(), header.descr) != row.descrs.end()) found = &row;
    }
    if (found == nullptr)
        fail("has the type " + type_text(header.descr) + "; little-endian " + join(accepted) +
             (types.size() > 1 ? " are" : " is") + " accepted");
    const std::vector<std::uint64_t>& shape = header.shape;
    const bool fits = columns == 0 ? shape.size() == 1 : shape.size() == 2 && shape[1] == columns;
    if (!fits)
        fail("has the shape " + shape_text(shape) + "; " +
             (columns == 0 ? "(n,)" : "(n, " + std::to_string(columns) + ")") + " is accepted");
    if (shape[0] > max_bodies)
        fail("has " + std::to_string(shape[0]) + " rows; at most " + std::to_string(max_bodies) + " are accepted");

    type_ = found->type;
    rows_ = shape[0];
    columns_ = columns == 0 ? 1 : columns;
    by_columns_ = header.fortran_order && columns_ > 1;
    const std::uint64_t promised = elements() * found->bytes, present = file_.size() - data_start;
    if (present < promised)
        fail("is truncated: its header promises " + std::to_string(promised) + " bytes of data and " +
             std::to_string(present) + " are there");
    if (present > promised)
        fail("has " + std::to_string(present - promised) + " bytes after the " + std::to_string(promised) +
             " of data that its header promises; none are accepted");
}

namespace {

template <class Element>
void transpose(const std::vector<unsigned char>& from, void* target, std::size_t rows, std::size_t columns) {
    const unsigned char* source = from.data();
    for (std::size_t c = 0; c < columns; ++c)
        for (std::size_t r = 0; r < rows; ++r, source += sizeof(Element))
            std::memcpy(static_cast<unsigned char*>(target) + (r * columns + c) * sizeof(Element), source,
                        sizeof(Element));
}

template <class Element, class T>
void convert(const std::vector<unsigned char>& from, std::vector<T>& to) {
    for (std::size_t i = 0; i < to.size(); ++i) {
        Element element;
        std::memcpy(&element, from.data() + i * sizeof element, sizeof element);
        to[i] = static_cast<T>(element);
    }
}

}  // namespace

void NpyFile::read_rows(void* target) {
    const std::size_t size = row_of(type_).bytes, bytes = elements() * size;
    if (!by_columns_) {
        file_.read(target, bytes);
        return;
    }
    std::vector<unsigned char> raw(bytes);
    file_.read(raw.data(), raw.size());
    if (size == 8)
        transpose<std::uint64_t>(raw, target, rows_, columns_);
    else if (size == 4)
        transpose<std::uint32_t>(raw, target, rows_, columns_);
    else
        transpose<std::uint8_t>(raw, target, rows_, columns_);
}

template <class T>
std::vector<T> NpyFile::read() {
    std::vector<unsigned char> raw(elements() * row_of(type_).bytes);
    read_rows(raw.data());
    std::vector<T> numbers(elements());
    switch (type_) {
        case NpyType::Float32:
            convert<float>(raw, numbers);
            break;
        case NpyType::Float64:
            convert<double>(raw, numbers);
            break;
        case NpyType::UInt8:
            convert<std::uint8_t>(raw, numbers);
            break;
        case NpyType::UInt32:
            convert<std::uint32_t>(raw, numbers);
            break;
    }
    return numbers;
}

template std::vector<double> NpyFile::read<double>();
template std::vector<std::uint32_t> NpyFile::read<std::uint32_t>();

std::string npy_header(std::string_view descr, const std::vector<std::uint64_t>& shape) {
    const bool columns = !descr.empty() && descr.front() == '[';
    const std::string type = columns ? std::string(descr) : "'" + std::string(descr) + "'";
    std::string text = "{'descr': " + type + ", 'fortran_order': False, 'shape': " + shape_text(shape) + ", }";
    const std::size_t start = magic.size() + 4;  // magic, version, length
    const std::size_t total = (start + text.size() + 1 + 63) / 64 * 64;
    text.append(total - start - text.size() - 1, ' ');
    text += '\n';
    std::string header(magic);
    header += '\x01';
    header += '\0';
    header += static_cast<char>(text.size() & 0xff);
    header += static_cast<char>(text.size() >> 8);
    return header + text;
}

}  // namespace clinch::io
