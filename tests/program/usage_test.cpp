// Wrong commands: status 2, one sentence on standard error, nothing written.
#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "tests/io/npy_bytes.hpp"
#include "tests/program/run_program.hpp"

namespace {

using namespace clinch::test;
using Catch::Contains;

struct Row {
    std::vector<std::string> arguments;
    const char* message;
};

void check_refused(const std::vector<std::string>& arguments, const std::string& message, int status = 2) {
    std::string line;
    for (const std::string& word : arguments) line += word + ' ';
    INFO(line);
    const ProgramRun run = run_program(arguments);
    CHECK(run.status == status);
    CHECK(run.out.empty());
    CHECK_THAT(run.err, Contains(message));
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
}

}  // namespace

TEST_CASE("wrong usage is refused", "[program]") {
    const TempFolder folder;
    const std::string boxes = folder.write("b.npy", npy("<f4", "(1, 6)", bytes<float>({0, 0, 0, 1, 1, 1})));
    const std::string out = folder / "out.csv";
    const std::vector<Row> rows{
        {{}, "subcommand is required"},
        {{"simulate", boxes, "-o", out}, "'simulate' is no command; devices, pairs, contacts, scene are accepted"},
        {{"calibrate"}, "'calibrate' is no command"},
        {{"pairs"}, "INPUT is required"},
        {{"pairs", boxes}, "--output is required"},
        {{"pairs", boxes, "-o"}, "--output"},
        {{"pairs", boxes, "-o", out, "extra"}, "extra"},
        {{"pairs", boxes, "-o", out, "--frames", "3"}, "--frames"},
        {{"pairs", boxes, "-o", out, "--tuning", "t.json"}, "--tuning"},
        {{"pairs", boxes, "-o", out, "--precision", "0.5", "--tolerance", "0.1"}, "--precision excludes --tolerance"},
        {{"pairs", boxes, "-o", out, "--precision", "1.5"}, "--precision is '1.5'; a number from 0 to 1 is accepted"},
        {{"pairs", boxes, "-o", out, "--precision", "nan"}, "--precision is 'nan'"},
        {{"pairs", boxes, "-o", out, "--tolerance", "-1"}, "--tolerance is '-1'"},
        {{"pairs", boxes, "-o", out, "--contacts-per-pair", "0"},
         "--contacts-per-pair is '0'; a whole number from 1 to 8"},
        {{"pairs", boxes, "-o", out, "--contacts-per-pair", "9"}, "--contacts-per-pair is '9'"},
        {{"pairs", boxes, "-o", out, "--order", "up"}, "--order is 'up'; sorted and any are accepted"},
        {{"pairs", boxes, "-o", out, "--repeat", "0"}, "--repeat is '0'"},
        {{"pairs", boxes, "-o", out, "--repeat", "two"}, "--repeat is 'two'"},
        {{"pairs", boxes, "-o", out, "--seed", "-1"}, "--seed is '-1'"},
        {{"pairs", boxes, "-o", out, "--algorithm", "brutal"}, "--algorithm is 'brutal'; auto, brute"},
        {{"pairs", boxes, "-o", out, "--devices", "fpga"}, "--devices is 'fpga'"},
        {{"pairs", boxes, "-o", out, "--devices", "0,"}, "--devices is '0,'"},
        {{"pairs", boxes, "-o", out, "--devices", "77"}, "--devices names device 77"},
        {{"pairs", boxes, "-o", folder / "out.txt"}, "ending '.txt'; .npy, .csv, or -"},
        {{"pairs", boxes, "-o", boxes}, "-o is the input"},
        {{"pairs", boxes, "-o", out, "--stats", boxes}, "--stats is the input"},
        {{"pairs", boxes, "-o", out, "--stats", out}, "--stats is the target of -o"},
        {{"pairs", boxes, "-o", out, "--tolerance", "0"}, "--tolerance is '0'; a number above 0 is accepted"},
        {{"contacts", boxes}, "--output is required"},
        {{"contacts", boxes, "-o", out, "--precision", "0.5", "--tolerance", "0.1"},
         "--precision excludes --tolerance"},
        {{"contacts", boxes, "-o", out, "--tolerance", "0"}, "--tolerance is '0'; a number above 0 is accepted"},
        {{"contacts", boxes, "-o", out, "--precision", "2"}, "--precision is '2'; a number from 0 to 1 is accepted"},
        {{"contacts", boxes, "-o", out, "--contacts-per-pair", "9"}, "--contacts-per-pair is '9'"},
        {{"contacts", boxes, "-o", out, "--algorithm", "brutal"}, "--algorithm is 'brutal'; auto, brute"},
        {{"contacts", boxes, "-o", folder / "out.json"}, "ending '.json'; .npy, .csv, or -"},
        {{"contacts", boxes, "-o", boxes}, "-o is the input"},
        {{"contacts", boxes, "-o", out, "--stats", out}, "--stats is the target of -o"},
        {{"scene", "unifrom", "--count", "3", "-o", folder / "s.npy"}, "'unifrom' is no kind of scene; uniform"},
        {{"scene", "uniform", "-o", folder / "s.npy"}, "--count is required"},
        {{"scene", "uniform", "--count", "3"}, "--output is required"},
        {{"scene", "uniform", "--count", "4294967296", "-o", folder / "s.npy"}, "0 to 4294967295 is accepted"},
        {{"scene", "uniform", "--count", "99999999999999999999", "-o", folder / "s.npy"},
         "0 to 4294967295 is accepted"},
        {{"scene", "uniform", "--count", "-1", "-o", folder / "s.npy"}, "--count is '-1'"},
        {{"scene", "uniform", "--count", "3", "--seed", "x", "-o", folder / "s.npy"}, "--seed is 'x'"},
        {{"scene", "uniform", "--count", "3", "-o", folder / "s.json"}, ".npy is accepted"},
        {{"scene", "uniform", "--count", "3", "-o", "-"}, ".npy is accepted"},
        {{"scene", "mix", "--count", "3", "-o", folder / "s.npy"}, "the ending .json is accepted for the kind mix"},
    };
    for (const Row& row : rows) check_refused(row.arguments, row.message);
    CHECK(folder.names() == std::vector<std::string>{"b.npy"});
    CHECK(content(boxes) == npy("<f4", "(1, 6)", bytes<float>({0, 0, 0, 1, 1, 1})));
}

TEST_CASE("bad input is refused and an older output stays", "[program]") {
    const TempFolder folder;
    const std::string data = bytes<float>({0, 0, 0, 1, 1, 1});
    folder.write("cut.npy", npy("<f4", "(2, 6)", data));
    folder.write("long.npy", npy("<f4", "(1, 6)", data + "x"));
    folder.write("type.npy", npy("<i4", "(1, 6)", data));
    folder.write("shape.npy", npy("<f4", "(2, 3)", data));
    folder.write("huge.npy", npy("<f4", "(4294967296, 6)", data));
    folder.write("key.json", R"({"bodies": [{"shape": {"type": "sphere", "radus": 1}}]})");
    folder.write("twice.json", R"({"bodies": [], "bodies": []})");
    folder.write("nan.json", R"({"bodies": [{"shape": {"type": "sphere", "radius": NaN}}]})");
    folder.write("mesh.json", R"({"meshes": {"a": "none.stl"}, "bodies": []})");
    folder.write("count.json", R"({"bodies": {"count": 4294967296, "shape": {"type": "sphere", "radius": 1}}})");
    folder.write("empty.glb", "");
    folder.write("text.txt", "hello");
    folder.write("old.csv", "older result\n");
    folder.write("old.json", "older statistics\n");
    const std::vector<std::string> before = folder.names();

    const struct {
        const char* name;
        const char* message;
    } faults[] = {
        {"none.npy", "none.npy: there is no such file"},
        {"cut.npy", "cut.npy: is truncated"},
        {"long.npy", "long.npy: has 1 bytes after"},
        {"type.npy", "type.npy: has the type '<i4'"},
        {"shape.npy", "shape.npy: has the shape (2, 3); (n, 6) is accepted"},
        {"huge.npy", "4294967296 rows; at most 4294967295 are accepted"},
        {"key.json", "bodies[0].shape.radus is no known key"},
        {"twice.json", "bodies stands twice"},
        {"nan.json", "no JSON document"},
        {"mesh.json", "meshes.a is 'none.stl' and there is no file"},
        {"count.json", "bodies.count is 4294967296; a whole number from 0 to 4294967295"},
        {"none.glb", "none.glb: there is no such file"},
        {"empty.glb", "empty.glb: is empty"},
        {"text.txt", "text.txt: has the ending '.txt'"},
    };
    for (const auto& fault : faults) {
        check_refused({"pairs", folder / fault.name, "-o", folder / "old.csv", "--stats", folder / "old.json"},
                      fault.message);
        CHECK(content(folder / "old.csv") == "older result\n");
        CHECK(content(folder / "old.json") == "older statistics\n");
    }
    CHECK(folder.names() == before);
}
