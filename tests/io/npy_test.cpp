// .npy files: what is read, and every fault that is refused.
#include "tools/io/npy.hpp"

#include <catch2/catch.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/io/npy_bytes.hpp"
#include "tests/io/temp_folder.hpp"
#include "tools/io/error.hpp"

namespace {

using namespace clinch::test;
using Catch::Contains;
using clinch::io::InputError;
using clinch::io::NpyFile;
using clinch::io::NpyType;

const std::vector<float> six{1, 2, 3, 4, 5, 6};

/// Opens bytes as boxes are opened.
void open(const TempFolder& folder, const std::string& file, std::uint64_t columns = 6) {
    NpyFile(folder.write("a.npy", file), {NpyType::Float32, NpyType::Float64}, columns);
}

}  // namespace

TEST_CASE(".npy files of every version and order are read", "[host]") {
    const TempFolder folder;
    const std::vector<float> rows{1, 2, 3, 4, 5, 6};
    const std::vector<float> columns{1, 4, 2, 5, 3, 6};  // the same (2, 3) array column by column
    const std::vector<double> expected{1, 2, 3, 4, 5, 6};
    for (const int version : {1, 2, 3})
        for (const bool fortran : {false, true}) {
            INFO("version " << version << " fortran " << fortran);
            NpyFile file(folder.write("a.npy", npy("<f4", "(2, 3)", bytes(fortran ? columns : rows), version, fortran)),
                         {NpyType::Float32}, 3);
            CHECK(file.rows() == 2);
            CHECK(file.read<double>() == expected);
        }
    NpyFile doubles(folder.write("a.npy", npy("<f8", "(3, 2)", bytes<double>({1, 3, 5, 2, 4, 6}), 1, true)),
                    {NpyType::Float64}, 2);
    CHECK(doubles.read<double>() == expected);
    NpyFile small(folder.write("a.npy", npy("|u1", "(3,)", bytes<std::uint8_t>({0, 3, 255}), 1, true)),
                  {NpyType::UInt8}, 0);
    CHECK(small.read<std::uint32_t>() == std::vector<std::uint32_t>{0, 3, 255});
    NpyFile whole(folder.write("a.npy", npy("<u4", "(2,)", bytes<std::uint32_t>({7, 4294967295u}))), {NpyType::UInt32},
                  0);
    CHECK(whole.read<std::uint32_t>() == std::vector<std::uint32_t>{7, 4294967295u});
    NpyFile none(folder.write("a.npy", npy("<f4", "(0, 6)", "")), {NpyType::Float32}, 6);
    CHECK(none.rows() == 0);
    CHECK(none.read<double>().empty());
}

TEST_CASE("an .npy header may be spelled freely", "[host]") {
    const TempFolder folder;
    for (const char* const header : {
             "{\"shape\":(1,6),\"descr\":\"<f4\",\"fortran_order\":False}",
             "  { 'fortran_order' :True, 'shape' : ( 1 , 6 , ) , 'descr' : '<f4' , } \n",
         }) {
        INFO(header);
        NpyFile file(folder.write("a.npy", npy_raw(header, bytes(six))), {NpyType::Float32}, 6);
        CHECK(file.read<double>() == std::vector<double>{1, 2, 3, 4, 5, 6});
    }
}

TEST_CASE("faults of an .npy file are named", "[host]") {
    const TempFolder folder;
    const std::string good = npy("<f4", "(1, 6)", bytes(six));
    open(folder, good);

    struct Row {
        const char* what;
        std::string file;
        const char* message;
    };
    const std::string data = bytes(six);
    const std::vector<Row> faults{
        {"empty", "", "0 bytes"},
        {"another format", "PK\x03\x04 something else", "does not begin"},
        {"version 4", npy("<f4", "(1, 6)", data, 4), "version 4.0"},
        {"ends in length", good.substr(0, 9), "within its header"},
        {"ends in header", good.substr(0, 40), "within it"},
        {"data cut", good.substr(0, good.size() - 1), "promises 24 bytes of data and 23 are there"},
        {"no data", good.substr(0, good.size() - 24), "promises 24 bytes of data and 0 are there"},
        {"trailing byte", good + '\0', "has 1 bytes after"},
        {"half", npy("<f2", "(1, 6)", data), "'<f2'; little-endian float32, float64 are accepted"},
        {"whole numbers", npy("<i4", "(1, 6)", data), "'<i4'"},
        {"big-endian", npy(">f4", "(1, 6)", data), "big-endian"},
        {"text", npy("<U3", "(1, 6)", data), "'<U3'"},
        {"objects", npy("|O", "(1, 6)", data), "'|O'"},
        {"structured", npy_raw("{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (6,), }\n", data),
         "structured"},
        {"one dimension", npy("<f4", "(6,)", data), "the shape (6,); (n, 6) is accepted"},
        {"no dimension", npy("<f4", "()", data), "the shape ()"},
        {"three dimensions", npy("<f4", "(1, 1, 6)", data), "the shape (1, 1, 6)"},
        {"five columns", npy("<f4", "(1, 5)", data), "the shape (1, 5)"},
        {"transposed", npy("<f4", "(6, 1)", data), "the shape (6, 1)"},
        {"2^32 rows", npy("<f4", "(4294967296, 6)", data), "4294967296 rows; at most 4294967295"},
        {"2^63 rows", npy("<f8", "(9223372036854775808, 6)", data), "9223372036854775808 rows"},
        {"2^32 - 1 rows", npy("<f8", "(4294967295, 6)", data), "promises 206158430160 bytes"},
        {"2^64 rows", npy("<f4", "(18446744073709551616, 6)", data), "passes 2^64 - 1"},
        {"negative size", npy("<f4", "(-1, 6)", data), "no whole number"},
        {"no tuple", npy("<f4", "(6)", data), "no tuple"},
        {"a list", npy("<f4", "[1, 6]", data), "lacks '('"},
        {"unknown key", npy_raw("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 6), 'more': 1}\n", data),
         "'more'"},
        {"key twice", npy_raw("{'descr': '<f4', 'descr': '<f4', 'fortran_order': False, 'shape': (1, 6)}\n", data),
         "twice"},
        {"missing key", npy_raw("{'descr': '<f4', 'shape': (1, 6)}\n", data), "lacks one of the keys"},
        {"bad order", npy_raw("{'descr': '<f4', 'fortran_order': 0, 'shape': (1, 6)}\n", data),
         "neither True nor False"},
        {"more text", npy_raw("{'descr': '<f4', 'fortran_order': False, 'shape': (1, 6)} x\n", data), "goes on"},
        {"no header", npy_raw("", data), "lacks '{'"},
        {"unclosed", npy_raw("{'descr': '<f4", data), "quoted"},
        {"no comma", npy_raw("{'descr': '<f4' 'fortran_order': False, 'shape': (1, 6)}\n", data), "comma"},
    };
    for (const Row& fault : faults) {
        INFO(fault.what);
        CHECK_THROWS_AS(open(folder, fault.file), InputError);
        CHECK_THROWS_WITH(open(folder, fault.file), Contains("a.npy: ") && Contains(fault.message));
    }
}

TEST_CASE("every truncation of an .npy file is refused", "[host]") {
    const TempFolder folder;
    for (const int version : {1, 2}) {
        const std::string good = npy("<f8", "(2, 3)", std::string(48, '\1'), version);
        for (std::size_t length = 0; length < good.size(); ++length) {
            INFO("version " << version << " cut to " << length);
            REQUIRE_THROWS_AS(open(folder, good.substr(0, length), 3), InputError);
        }
        CHECK_NOTHROW(open(folder, good, 3));
    }
}

TEST_CASE("what is no readable file is refused", "[host]") {
    const TempFolder folder;
    CHECK_THROWS_WITH(NpyFile(folder / "none.npy", {NpyType::Float32}, 6), Contains("none.npy: there is no such file"));
    CHECK_THROWS_WITH(NpyFile(folder.path().string(), {NpyType::Float32}, 6), Contains("is no regular file"));
    CHECK_THROWS_AS(NpyFile(folder / "none.npy", {NpyType::Float32}, 6), InputError);
}

TEST_CASE("an .npy header is written as NumPy reads it", "[host]") {
    for (const std::uint64_t rows : {std::uint64_t{0}, std::uint64_t{7}, std::uint64_t{18446744073709551615u}}) {
        const std::string header = clinch::io::npy_header("<u4", {rows, 2});
        CHECK(header.size() % 64 == 0);
        CHECK(header == npy("<u4", "(" + std::to_string(rows) + ", 2)", ""));
    }
    CHECK(clinch::io::npy_header("<f8", {5}) == npy("<f8", "(5,)", ""));
}
