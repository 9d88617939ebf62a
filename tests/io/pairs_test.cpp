// Pairs into files, and files that appear only when complete.
#include "tools/io/pairs.hpp"

#include <catch2/catch.hpp>
#include <cstdint>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "tests/io/npy_bytes.hpp"
#include "tests/io/temp_folder.hpp"
#include "tools/io/error.hpp"
#include "tools/io/output_file.hpp"

namespace {

using namespace clinch::test;
using Catch::Contains;
using clinch::Pair;
using clinch::io::InputError;
using clinch::io::OutputError;
using clinch::io::OutputFile;
using clinch::io::TableFormat;

std::string written(const TempFolder& folder, TableFormat format, const std::vector<Pair>& pairs) {
    OutputFile file(folder / "out");
    clinch::io::write_pairs(file, format, pairs);
    file.commit();
    return content(folder / "out");
}

}  // namespace

TEST_CASE("pairs are written as .npy and .csv", "[host]") {
    const TempFolder folder;
    const std::vector<Pair> pairs{{0, 1}, {0, 4294967294u}, {10, 200}};
    CHECK(written(folder, TableFormat::Csv, pairs) == "a,b\n0,1\n0,4294967294\n10,200\n");
    CHECK(written(folder, TableFormat::Csv, {}) == "a,b\n");
    CHECK(written(folder, TableFormat::Npy, pairs) ==
          npy("<u4", "(3, 2)", bytes<std::uint32_t>({0, 1, 0, 4294967294u, 10, 200})));
    CHECK(written(folder, TableFormat::Npy, {}) == npy("<u4", "(0, 2)", ""));
}

TEST_CASE("a long .csv loses no row between blocks", "[host]") {
    const TempFolder folder;
    std::vector<Pair> pairs;
    std::ostringstream expected;
    expected << "a,b\n";
    for (std::uint32_t i = 0; i < 50000; ++i) {
        pairs.push_back({i * 85899u, 4294967295u - i});
        expected << pairs.back().a << ',' << pairs.back().b << '\n';
    }
    CHECK(written(folder, TableFormat::Csv, pairs) == expected.str());
}

TEST_CASE("the format follows from the target's name", "[host]") {
    CHECK(clinch::io::table_format("a/b.npy") == TableFormat::Npy);
    CHECK(clinch::io::table_format("B.CSV") == TableFormat::Csv);
    CHECK(clinch::io::table_format("-") == TableFormat::Csv);
    for (const char* const name : {"a.txt", "a", "", ".npy", "npy"}) {
        INFO(name);
        CHECK_THROWS_AS(clinch::io::table_format(name), InputError);
        CHECK_THROWS_WITH(clinch::io::table_format(name), Contains(".npy, .csv, or -"));
    }
}

TEST_CASE("a file that is not committed leaves no trace", "[host]") {
    const TempFolder folder;
    folder.write("old.csv", "old");
    {
        OutputFile file(folder / "old.csv");
        file.write("new");
        CHECK(content(folder / "old.csv") == "old");
        CHECK(folder.names().size() == 2);
        file.finish();
        CHECK(content(folder / "old.csv") == "old");
    }
    CHECK(folder.names() == std::vector<std::string>{"old.csv"});
    CHECK(content(folder / "old.csv") == "old");
    {
        OutputFile file(folder / "old.csv");
        file.write("new");
        file.commit();
    }
    CHECK(folder.names() == std::vector<std::string>{"old.csv"});
    CHECK(content(folder / "old.csv") == "new");
}

TEST_CASE("a link is followed and permissions are kept", "[host]") {
    namespace fs = std::filesystem;
    const TempFolder folder;
    fs::create_directory(folder / "sub");
    folder.write("sub/real.csv", "old");
    fs::permissions(folder / "sub/real.csv", fs::perms::owner_read | fs::perms::owner_write);
    fs::create_symlink("sub/real.csv", folder / "link.csv");
    OutputFile file(folder / "link.csv");
    file.write("new");
    file.commit();
    CHECK(fs::is_symlink(folder / "link.csv"));
    CHECK(content(folder / "sub/real.csv") == "new");
    CHECK(fs::status(folder / "sub/real.csv").permissions() == (fs::perms::owner_read | fs::perms::owner_write));
}

TEST_CASE("a target that cannot be written is a failure of the run", "[host]") {
    const TempFolder folder;
    CHECK_THROWS_AS(OutputFile(folder / "none/x.csv"), OutputError);
    CHECK_THROWS_WITH(OutputFile(folder / "none/x.csv"), Contains("none/x.csv: cannot be opened for writing"));
    CHECK_THROWS_WITH(OutputFile(folder.path().string()), Contains("is a folder"));
    CHECK_THROWS_AS(clinch::io::check_writable(folder / "none/x.csv"), OutputError);
    clinch::io::check_writable(folder / "x.csv");
    CHECK(folder.names().empty());
}

TEST_CASE("a device is written directly, and a full one is a failure", "[host]") {
    namespace fs = std::filesystem;
    REQUIRE(fs::is_character_file("/dev/full"));
    OutputFile file("/dev/full");
    file.write("x");
    CHECK_THROWS_AS(file.commit(), OutputError);
    OutputFile null("/dev/null");
    null.write("x");
    null.commit();
    CHECK(fs::is_character_file("/dev/null"));
}
