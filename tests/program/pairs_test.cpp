// clinch pairs on inputs that are right: files, rejected bodies, statistics, targets that cannot be written.
#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "bench/scenes/boxes.hpp"
#include "tests/io/npy_bytes.hpp"
#include "tests/program/run_program.hpp"

namespace {

using namespace clinch::test;
using Catch::Contains;
using Json = nlohmann::json;

std::string box_file(const TempFolder& folder, const std::vector<float>& numbers) {
    return folder.write("b.npy", npy("<f4", "(" + std::to_string(numbers.size() / 6) + ", 6)", bytes(numbers)));
}

const std::string five_bodies = R"({"bodies": [
    {"name": "left", "shape": {"type": "sphere", "radius": 1}},
    {"shape": {"type": "box", "half_extents": [1, 1, 1]}, "position": [1.5, 0, 0]},
    {"shape": {"type": "capsule", "radius": 0.5, "half_height": 1}, "position": [9, 0, 0]},
    {"shape": {"type": "cone", "radius": 0.5, "half_height": 1}, "position": [9, 0.5, 0], "motion": "static"},
    {"shape": {"type": "plane", "normal": [0, 0, 1], "offset": -1}}]})";

/// Runs on the host, where the result does not depend on a device.
ProgramRun host_pairs(const std::string& input, const std::string& output, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"pairs", input, "-o", output, "--algorithm", "host-brute"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
}

}  // namespace

TEST_CASE("few bodies give the pairs they should", "[program]") {
    const TempFolder folder;
    const struct {
        const char* what;
        std::vector<float> numbers;
        const char* pairs;
    } rows[] = {
        {"no body", {}, "a,b\n"},
        {"one body", {0, 0, 0, 1, 1, 1}, "a,b\n"},
        {"two identical bodies", {0, 0, 0, 1, 1, 1, 0, 0, 0, 1, 1, 1}, "a,b\n0,1\n"},
        {"touching faces", {0, 0, 0, 1, 1, 1, 1, 0, 0, 2, 1, 1}, "a,b\n0,1\n"},
        {"points", {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "a,b\n0,1\n"},
        {"apart", {0, 0, 0, 1, 1, 1, 2, 0, 0, 3, 1, 1}, "a,b\n"},
    };
    for (const auto& row : rows)
        for (const char* const algorithm : {"auto", "brute", "host-brute"}) {
            INFO(row.what << " by " << algorithm);
            const ProgramRun run =
                run_program({"pairs", box_file(folder, row.numbers), "-o", "-", "--algorithm", algorithm});
            CHECK(run.status == 0);
            CHECK(run.out == row.pairs);
            CHECK(run.complaints().empty());
        }
    const ProgramRun none = host_pairs(folder.write("e.json", R"({"bodies": []})"), "-");
    CHECK(none.status == 0);
    CHECK(none.out == "a,b\n");
}

TEST_CASE("all targets hold the same pairs, with every algorithm", "[program]") {
    const TempFolder folder;
    REQUIRE(run_program({"scene", "uniform", "--count", "2000", "--seed", "5", "-o", folder / "u.npy"}).status == 0);
    const std::vector<clinch::Aabb> boxes = clinch::scenes::make_boxes("uniform", 2000, 5);
    std::string csv = "a,b\n";
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t a = 0; a < boxes.size(); ++a)
        for (std::uint32_t b = a + 1; b < boxes.size(); ++b)
            if (clinch::overlap(boxes[a], boxes[b])) {
                csv += std::to_string(a) + ',' + std::to_string(b) + '\n';
                numbers.insert(numbers.end(), {a, b});
            }
    const std::string shape = "(" + std::to_string(numbers.size() / 2) + ", 2)";
    REQUIRE(numbers.size() > 200);
    for (const char* const algorithm : {"auto", "brute", "host-brute"}) {
        INFO(algorithm);
        CHECK(run_program({"pairs", folder / "u.npy", "-o", folder / "o.csv", "--algorithm", algorithm}).status == 0);
        CHECK(content(folder / "o.csv") == csv);
        CHECK(run_program({"pairs", folder / "u.npy", "-o", folder / "o.npy", "--algorithm", algorithm}).status == 0);
        CHECK(content(folder / "o.npy") == npy("<u4", shape, bytes(numbers)));
    }
    // Unsorted: the same rows, in whatever order.
    CHECK(run_program({"pairs", folder / "u.npy", "-o", folder / "o.csv", "--order", "any"}).status == 0);
    const std::string any = content(folder / "o.csv");
    CHECK(any.size() == csv.size());
    const auto lines = [](const std::string& text) {
        std::multiset<std::string> all;
        for (std::size_t at = 0, end = 0; (end = text.find('\n', at)) != std::string::npos; at = end + 1)
            all.insert(text.substr(at, end - at));
        return all;
    };
    CHECK(lines(any) == lines(csv));
}

TEST_CASE("scene files and mesh files go through the whole pipeline", "[program]") {
    const TempFolder folder;
    const std::string scene = folder.write("five.json", five_bodies);
    const char* const expected = "a,b\n0,1\n0,4\n1,4\n2,3\n2,4\n";
    for (const char* const algorithm : {"auto", "brute", "host-brute"}) {
        INFO(algorithm);
        const ProgramRun run = run_program({"pairs", scene, "-o", "-", "--algorithm", algorithm, "--repeat", "3"});
        CHECK(run.status == 0);
        CHECK(run.out == expected);
        CHECK(run.complaints().empty());
    }
    const std::string mesh = folder.write("m.obj",
                                          "o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no none\nv 9 9 9\nv 8 8 8\nl 4 5\n"
                                          "o b\nv 0.5 0 0\nv 1.5 0 0\nv 0.5 1 0\nf 6 7 8\n");
    const ProgramRun run = host_pairs(mesh, "-");
    CHECK(run.status == 0);
    CHECK(run.out == "a,b\n0,2\n");
    CHECK_THAT(run.err, Contains("warning: ") && Contains("body 1 ('none') is rejected") && Contains("triangle"));
}

TEST_CASE("rejected bodies are warned of, or refused under --strict", "[program]") {
    const TempFolder folder;
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<float> numbers{0, 0, 0, 1, 1, 1};
    for (int i = 0; i < 7; ++i) numbers.insert(numbers.end(), {0, nan, 0, 1, 1, 1});
    numbers.insert(numbers.end(), {0, 0, 0, 1, 1, 1});
    const std::string input = box_file(folder, numbers);
    for (const char* const algorithm : {"brute", "host-brute"}) {
        INFO(algorithm);
        const ProgramRun run =
            run_program({"pairs", input, "-o", "-", "--stats", folder / "s.json", "--algorithm", algorithm});
        CHECK(run.status == 0);
        CHECK(run.out == "a,b\n0,8\n");
        CHECK_THAT(run.err, Contains("body 1 is rejected: min y is nan and must be finite") &&
                                Contains("2 more bodies are rejected"));
        const Json stats = Json::parse(content(folder / "s.json"));
        CHECK(stats["bodies"] == 9);
        REQUIRE(stats["rejected"].size() == 7);
        CHECK(stats["rejected"][6] == Json({{"body", 7}, {"why", "min y is nan and must be finite"}}));
    }
    folder.write("old.csv", "older\n");
    const std::vector<std::string> before = folder.names();
    const ProgramRun strict = host_pairs(input, folder / "old.csv", {"--strict", "--stats", folder / "new.json"});
    CHECK(strict.status == 2);
    CHECK_THAT(strict.err, Contains("body 1 is rejected: min y is nan"));
    CHECK(content(folder / "old.csv") == "older\n");
    CHECK(folder.names() == before);
    // In a scene the same, by the body's name.
    const std::string scene =
        folder.write("s.json", R"({"bodies": [{"name": "bad", "shape": {"type": "sphere", "radius": -1}}]})");
    CHECK(host_pairs(scene, "-").status == 0);
    const ProgramRun refused = host_pairs(scene, "-", {"--strict"});
    CHECK(refused.status == 2);
    CHECK(refused.out.empty());
    CHECK_THAT(refused.err, Contains("body 0 ('bad') is rejected"));
}

TEST_CASE("statistics of five bodies show that nothing was built for them", "[program]") {
    const TempFolder folder;
    const std::string scene = folder.write("five.json", five_bodies);
    REQUIRE(
        run_program({"pairs", scene, "-o", folder / "o.csv", "--stats", folder / "s.json", "--repeat", "3"}).status ==
        0);
    const Json stats = Json::parse(content(folder / "s.json"));
    CHECK(stats["bodies"] == 5);
    CHECK(stats["pairs"] == 5);
    CHECK(stats["contacts"] == 0);
    CHECK(stats["frames"] == 1);
    CHECK(stats["algorithm"] == "host-sweep");
    CHECK(stats["rejected"].empty());
    CHECK(stats["tolerance_missed"] == 0);
    REQUIRE_FALSE(stats["devices"].empty());
    for (const Json& device : stats["devices"]) {
        CHECK(device["context_created"] == false);
        CHECK(device["kernels_built"].empty());
        CHECK(device["kernels_cached"].empty());
        CHECK(device["peak_bytes"] == 0);
        CHECK_FALSE(device["name"].get<std::string>().empty());
        CHECK_FALSE(device["platform"].get<std::string>().empty());
        CHECK(device["index"].is_number_unsigned());
    }
    CHECK(stats["skipped"]["bounds"] == 0);
    CHECK(stats["skipped"]["pairs_filtered"] == 0);
    CHECK(stats["skipped"]["static_pairs"] == 1);  // the cone in the plane
    CHECK(stats["skipped"]["pairs_cached"] == 0);
    for (const char* const none : {"unchanged", "inside", "still"}) CHECK(stats["skipped"].at(none) == 0);
    CHECK(stats["skipped"]["kernels_not_built"] > 2);
    CHECK(stats["peak_bytes"]["host"] > 1000000);
    CHECK(stats["peak_bytes"]["device"] == 0);
    for (const char* const stage : {"total", "upload", "bounds", "broad", "narrow", "download"})
        CHECK(stats["ms"][stage] >= 0.0);
    CHECK(stats["ms"]["total"] > 0.0);
    for (const char* const once : {"read", "build", "first"}) CHECK(stats["ms_once"][once] >= 0.0);
    CHECK(stats["ms_once"]["first"] > 0.0);
}

TEST_CASE("statistics of a device tell which kernels it needed", "[program]") {
    const TempFolder folder;
    REQUIRE(run_program({"scene", "density", "--count", "700", "-o", folder / "d.npy"}).status == 0);
    // A cache of its own, empty at first: built once, read the second time.
    const std::map<std::string, std::string> cache{{"XDG_CACHE_HOME", folder / "cache"}};
    std::size_t modules = 0;
    for (const bool first : {true, false}) {
        INFO("first " << first);
        REQUIRE(run_program({"pairs", folder / "d.npy", "-o", folder / "o.npy", "--stats", folder / "s.json",
                             "--algorithm", "brute", "--devices", "0"},
                            cache)
                    .status == 0);
        const Json stats = Json::parse(content(folder / "s.json"));
        CHECK(stats["algorithm"] == "brute");
        REQUIRE(stats["devices"].size() == 1);
        const Json& device = stats["devices"][0];
        CHECK(device["context_created"] == true);
        CHECK(device["peak_bytes"] > 0);
        CHECK(stats["peak_bytes"]["device"] == device["peak_bytes"]);
        CHECK(device[first ? "kernels_cached" : "kernels_built"].empty());
        const std::size_t used = device[first ? "kernels_built" : "kernels_cached"].size();
        CHECK(used > 0);
        if (first) modules = used;
        CHECK(used == modules);
        CHECK(stats["skipped"]["kernels_not_built"] >= 1);
        CHECK(stats["ms_once"]["build"] > 0.0);
    }
}

TEST_CASE("a target that cannot be written fails the run", "[program]") {
    const TempFolder folder;
    const std::string input = box_file(folder, {0, 0, 0, 1, 1, 1, 0, 0, 0, 1, 1, 1});
    const ProgramRun missing = host_pairs(input, folder / "none/o.csv");
    CHECK(missing.status == 1);
    CHECK_THAT(missing.err, Contains("none/o.csv: cannot be opened for writing"));
    const ProgramRun stats = host_pairs(input, folder / "o.csv", {"--stats", folder / "none/s.json"});
    CHECK(stats.status == 1);
    CHECK(folder.names() == std::vector<std::string>{"b.npy"});
    CHECK(run_program({"scene", "cubes", "--count", "3", "-o", folder / "none/s.npy"}).status == 1);
    const ProgramRun full =
        run_shell("\"$CLINCH_PROGRAM\" pairs '" + input + "' -o - --algorithm host-brute > /dev/full");
    CHECK(full.status == 1);
    CHECK_THAT(full.err, Contains("standard output: cannot be written"));
}

TEST_CASE("a disk that fills up leaves the older output and no part of the new", "[program]") {
    const TempFolder folder;
    REQUIRE(run_program({"scene", "clusters", "--count", "20000", "-o", folder / "c.npy"}).status == 0);
    folder.write("o.csv", "older\n");
    const std::vector<std::string> before = folder.names();
    // Files of at most 100 KiB; without the signal a write that passes it fails as one to a full disk does.
    const ProgramRun run = run_shell("trap '' XFSZ; ulimit -f 200; \"$CLINCH_PROGRAM\" pairs '" + folder / "c.npy" +
                                     "' -o '" + (folder / "o.csv") + "' --algorithm host-brute");
    CHECK(run.status == 1);
    CHECK_THAT(run.err, Contains("o.csv: cannot be written"));
    CHECK(content(folder / "o.csv") == "older\n");
    CHECK(folder.names() == before);
}

TEST_CASE("statistics tell how many bodies that cannot move were not looked at again", "[program]") {
    const TempFolder folder;
    constexpr int bodies = 6000, still = 2000;
    std::string rows;
    for (int i = 0; i < bodies; ++i)
        rows += std::string(i == 0 ? "" : ",\n") + R"({"shape": {"type": "sphere", "radius": 0.6}, "position": [)" +
                std::to_string(i) + R"(, 0, 0], "motion": ")" + (i < still ? "static" : "dynamic") + R"("})";
    const std::string scene = folder.write("row.json", R"({"bodies": [)" + rows + "]}");
    REQUIRE(run_program({"pairs", scene, "-o", folder / "o.npy", "--stats", folder / "s.json", "--algorithm", "bvh",
                         "--devices", "0", "--repeat", "2"})
                .status == 0);
    const Json stats = Json::parse(content(folder / "s.json"));
    CHECK(stats["algorithm"] == "bvh");
    CHECK(stats["pairs"] == bodies - still);  // each moving one with the one before it
    CHECK(stats["skipped"].at("still") == still);
}
