// clinch contacts: files, boxes as bodies, rejected bodies, statistics.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "bench/scenes/boxes.hpp"
#include "tests/io/npy_bytes.hpp"
#include "tests/program/run_program.hpp"

namespace {

using namespace clinch::test;
using Catch::Contains;
using Json = nlohmann::json;

const std::string header = "a,b,ax,ay,az,bx,by,bz,nx,ny,nz,distance,error,feature\n";

struct Row {
    std::uint32_t a = 0, b = 0;
    std::array<double, 3> on_a{}, on_b{}, normal{};
    double distance = 0.0, error = 0.0;
    std::uint32_t feature = 0;
};

/// The rows of a .csv with contacts.
std::vector<Row> parse(const std::string& csv) {
    REQUIRE(csv.compare(0, header.size(), header) == 0);
    std::vector<Row> rows;
    for (const char* at = csv.c_str() + header.size(); *at != '\0';) {
        const auto next = [&at] {
            char* end = nullptr;
            const double x = std::strtod(at, &end);
            at = end + 1;
            return x;
        };
        Row row;
        row.a = static_cast<std::uint32_t>(next());
        row.b = static_cast<std::uint32_t>(next());
        for (auto* const v : {&row.on_a, &row.on_b, &row.normal})
            for (double& x : *v) x = next();
        row.distance = next();
        row.error = next();
        row.feature = static_cast<std::uint32_t>(next());
        rows.push_back(row);
    }
    return rows;
}

template <class Number>
std::string box_file(const TempFolder& folder, const std::vector<Number>& numbers) {
    return folder.write("b.npy", npy(sizeof(Number) == 4 ? "<f4" : "<f8",
                                     "(" + std::to_string(numbers.size() / 6) + ", 6)", bytes(numbers)));
}

std::vector<Row> contacts(const std::string& input, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"contacts", input, "-o", "-"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProgramRun run = run_program(arguments);
    INFO(run.err);
    REQUIRE(run.status == 0);
    return parse(run.out);
}

const std::string five_bodies = R"({"bodies": [
    {"name": "left", "shape": {"type": "sphere", "radius": 1}},
    {"shape": {"type": "sphere", "radius": 0.75}, "position": [1.5, 0, 0]},
    {"shape": {"type": "capsule", "radius": 0.5, "half_height": 1}, "position": [9, 0, 0.25]},
    {"shape": {"type": "sphere", "radius": 0.5}, "position": [9, 1, 0.25], "motion": "static"},
    {"shape": {"type": "plane", "normal": [0, 0, 1], "offset": -1}}]})";

}  // namespace

TEST_CASE("contacts of few bodies are those that are known", "[program]") {
    const TempFolder folder;
    const std::string scene = folder.write("five.json", five_bodies);
    for (const char* const precision : {"0", "0.5", "1"}) {
        INFO("precision " << precision);
        const std::vector<Row> rows = contacts(scene, {"--precision", precision});
        // The sphere 0 touches the plane in a point, as does the static ball the capsule.
        const struct {
            std::uint32_t a, b;
            double distance;
            std::array<double, 3> normal, on_a;
        } known[] = {
            {0, 1, -0.25, {1, 0, 0}, {1, 0, 0}},
            {0, 4, 0.0, {0, 0, -1}, {0, 0, -1}},
            {2, 3, 0.0, {0, 1, 0}, {9, 0.5, 0.25}},
            {2, 4, -0.25, {0, 0, -1}, {9, 0, -1.25}},
        };
        REQUIRE(rows.size() == 4);
        for (std::size_t i = 0; i < 4; ++i) {
            INFO("row " << i);
            CHECK(rows[i].a == known[i].a);
            CHECK(rows[i].b == known[i].b);
            CHECK(std::fabs(rows[i].distance - known[i].distance) <= rows[i].error);
            CHECK(rows[i].error < 1e-4);
            CHECK(rows[i].feature == 0);
            for (std::size_t d = 0; d < 3; ++d) {
                CHECK(rows[i].normal[d] == Approx(known[i].normal[d]).margin(1e-6));
                // Where on the capsule's side is anybody's choice.
                if (!(i == 2 && d == 2)) CHECK(rows[i].on_a[d] == Approx(known[i].on_a[d]).margin(1e-5));
                CHECK(rows[i].on_b[d] == Approx(rows[i].on_a[d] + rows[i].distance * rows[i].normal[d]).margin(1e-14));
            }
        }
    }
    CHECK(contacts(folder.write("e.json", R"({"bodies": []})")).empty());
}

TEST_CASE("rows of boxes are box shapes, of float32 and of float64", "[program]") {
    const TempFolder folder;
    // 0 and 1 share a face, 1 and 2 overlap by 0.25, 3 is apart, 4 lies deep in 0.
    const std::vector<float> numbers{0, 0, 0, 2, 2, 2, 2,  0,  0,  3,    2,    2,    2.75f, 0, 0,
                                     4, 2, 2, 9, 9, 9, 10, 10, 10, 0.5f, 0.5f, 0.5f, 1,     1, 1};
    const std::vector<double> wide(numbers.begin(), numbers.end());
    for (const bool doubles : {false, true}) {
        INFO("doubles " << doubles);
        const std::vector<Row> rows =
            contacts(doubles ? box_file(folder, wide) : box_file(folder, numbers), {"--contacts-per-pair", "1"});
        REQUIRE(rows.size() == 3);
        const double distances[] = {0.0, -1.0, -0.25};
        const std::uint32_t others[] = {1, 4, 2};
        for (std::size_t i = 0; i < 3; ++i) {
            CHECK(rows[i].a == (i == 2 ? 1u : 0u));
            CHECK(rows[i].b == others[i]);
            CHECK(std::fabs(rows[i].distance - distances[i]) <= rows[i].error);
            CHECK(rows[i].error < 1e-6);
        }
        CHECK(rows[0].normal[0] == Approx(1.0));
    }
}

TEST_CASE("boxes that share a face touch in its corners", "[program]") {
    const TempFolder folder;
    const std::string boxes = box_file<float>(folder, {0, 0, 0, 2, 2, 2, 2, 1, 1, 3, 4, 4});
    const std::vector<Row> rows = contacts(boxes);
    REQUIRE(rows.size() == 4);
    for (const Row& row : rows) {
        CHECK(std::fabs(row.distance) <= row.error);
        CHECK(row.on_a[0] == Approx(2.0));
        CHECK((std::fabs(row.on_a[1] - 1.0) < 1e-6 || std::fabs(row.on_a[1] - 2.0) < 1e-6));
        CHECK((std::fabs(row.on_a[2] - 1.0) < 1e-6 || std::fabs(row.on_a[2] - 2.0) < 1e-6));
    }
    CHECK(contacts(boxes, {"--contacts-per-pair", "2"}).size() == 2);
}

TEST_CASE("float64 boxes keep the promise that float32 could not", "[program]") {
    const TempFolder folder;
    // Gaps and overlaps of a few last digits, near and far from the origin.
    const double x = 1e6 + 0.1, step = std::nextafter(x, 2e6) - x;
    std::vector<double> numbers;
    const int moves[] = {-3, -1, 0, 1, 4000000};
    for (int i = 0; i < 5; ++i) {
        const double y = 10.0 * i;
        numbers.insert(numbers.end(), {x - 0.7, y, 0.1, x, y + 1.1, 0.3});
        numbers.insert(numbers.end(), {x + moves[i] * step, y, 0.1, x + 0.9, y + 1.1, 0.3});
    }
    const std::vector<Row> rows = contacts(box_file(folder, numbers), {"--precision", "1", "--contacts-per-pair", "1"});
    // Whoever touches or overlaps is there; the gap of 4,000,000 steps, half a thousandth, is not.
    std::vector<bool> there(5, false);
    for (const Row& row : rows) {
        REQUIRE(row.b == row.a + 1);
        const std::size_t pair = row.a / 2;
        there[pair] = true;
        CHECK(std::fabs(row.distance - moves[pair] * step) <= row.error);
        CHECK(row.error < 1e-8);
    }
    CHECK(there[0]);
    CHECK(there[1]);
    CHECK(there[2]);
    CHECK_FALSE(there[4]);
}

TEST_CASE("boxes of zero width touch as the flat things they are", "[program]") {
    const TempFolder folder;
    // A box; a face that cuts it in the middle, one that lies on it, one above it; a point in it and one on its corner.
    const std::vector<float> numbers{0, 0, 0, 2, 2, 2, -1, -1, 1,    3, 3, 1,    0, 0, 2, 2, 2, 2,
                                     0, 0, 3, 2, 2, 3, 1,  1,  0.5f, 1, 1, 0.5f, 2, 2, 2, 2, 2, 2};
    const ProgramRun run = run_program({"contacts", box_file(folder, numbers), "-o", "-", "--contacts-per-pair", "1"});
    REQUIRE(run.status == 0);
    CHECK(run.complaints().empty());
    const struct {
        std::uint32_t a, b;
        double distance;
    } known[] = {{0, 1, -1.0}, {0, 2, 0.0}, {0, 4, -0.5}, {0, 5, 0.0}, {2, 5, 0.0}};
    const std::vector<Row> rows = parse(run.out);
    REQUIRE(rows.size() == 5);
    for (std::size_t i = 0; i < 5; ++i) {
        INFO(i);
        CHECK(rows[i].a == known[i].a);
        CHECK(rows[i].b == known[i].b);
        CHECK(std::fabs(rows[i].distance - known[i].distance) <= rows[i].error);
        CHECK(rows[i].error < 1e-5);
    }
}

TEST_CASE("all targets hold the same contacts, with every algorithm and order", "[program]") {
    const TempFolder folder;
    REQUIRE(run_program({"scene", "mix", "--count", "700", "--seed", "3", "-o", folder / "m.json"}).status == 0);
    REQUIRE(run_program({"contacts", folder / "m.json", "-o", folder / "o.csv"}).status == 0);
    const std::string csv = content(folder / "o.csv");
    const std::vector<Row> rows = parse(csv);
    REQUIRE(rows.size() > 200);
    std::string data;
    std::size_t pairs = 1;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Row& row = rows[i];
        if (i > 0) {
            const Row& last = rows[i - 1];
            REQUIRE(std::tie(last.a, last.b, last.feature) < std::tie(row.a, row.b, row.feature));
            if (last.a != row.a || last.b != row.b) ++pairs;
        }
        REQUIRE(row.a < row.b);
        REQUIRE(row.distance - row.error <= 0.0);
        data += bytes(std::vector<std::uint32_t>{row.a, row.b});
        for (const auto& v : {row.on_a, row.on_b, row.normal}) data += bytes(std::vector<double>(v.begin(), v.end()));
        data += bytes(std::vector<double>{row.distance, row.error}) + bytes(std::vector<std::uint32_t>{row.feature});
    }
    for (const char* const algorithm : {"auto", "bvh", "host-sweep", "host-brute"}) {
        INFO(algorithm);
        const ProgramRun run = run_program({"contacts", folder / "m.json", "-o", "-", "--algorithm", algorithm});
        CHECK(run.status == 0);
        CHECK(run.out == csv);
    }
    REQUIRE(run_program({"contacts", folder / "m.json", "-o", folder / "o.npy", "--repeat", "2"}).status == 0);
    const std::string file = content(folder / "o.npy");
    REQUIRE(file.size() > data.size());
    CHECK(file.compare(file.size() - data.size(), std::string::npos, data) == 0);
    CHECK_THAT(file, Contains("('feature', '<u4')]") && Contains("(" + std::to_string(rows.size()) + ",)"));
    const std::vector<Row> any = contacts(folder / "m.json", {"--order", "any"});
    CHECK(any.size() == rows.size());
    CHECK(contacts(folder / "m.json", {"--contacts-per-pair", "1"}).size() == pairs);
    CHECK(rows.size() > pairs);
    CHECK(contacts(folder / "m.json", {"--contacts-per-pair", "8"}).size() > rows.size());
}

TEST_CASE("contacts need no device", "[program]") {
    const TempFolder folder;
    const std::string scene = folder.write("five.json", five_bodies);
    const ProgramRun run = run_program({"contacts", scene, "-o", "-", "--algorithm", "host-brute"},
                                       {{"OCL_ICD_VENDORS", folder / "none"}});
    CHECK(run.status == 0);
    CHECK(parse(run.out).size() == 4);
}

TEST_CASE("statistics of contacts tell what was done and what was not", "[program]") {
    const TempFolder folder;
    const std::string scene = folder.write("five.json", five_bodies);
    REQUIRE(run_program({"contacts", scene, "-o", folder / "o.csv", "--stats", folder / "s.json", "--repeat", "3"})
                .status == 0);
    const Json stats = Json::parse(content(folder / "s.json"));
    CHECK(stats["bodies"] == 5);
    CHECK(stats["pairs"] == 4);
    CHECK(stats["contacts"] == 4);
    CHECK(stats["tolerance_missed"] == 0);
    CHECK(stats["ms"]["narrow"] > 0.0);
    CHECK(stats["ms"]["narrow"] <= stats["ms"]["total"]);
    for (const char* const part : {"upload", "buckets", "routines", "manifolds", "gather"})
        CHECK(stats["ms_narrow"][part] >= 0.0);
    REQUIRE(stats["buckets"].size() == 4);
    CHECK(stats["buckets"][0] == Json({{"classes", "sphere-sphere"},
                                       {"routine", "narrow_phase/sphere_sphere"},
                                       {"numbers", "float64"},
                                       {"pairs", 1},
                                       {"again", 0}}));
    CHECK(stats["buckets"][3]["classes"] == "capsule-plane");
    CHECK(stats["skipped"]["cells"] == 23);
    // Four pairs wake no device.
    for (const Json& device : stats["devices"]) CHECK(device["context_created"] == false);

    REQUIRE(
        run_program({"contacts", scene, "-o", folder / "o.csv", "--stats", folder / "s.json", "--tolerance", "1e-30"})
            .status == 0);
    CHECK(Json::parse(content(folder / "s.json"))["tolerance_missed"] == 4);
    REQUIRE(run_program({"contacts", scene, "-o", folder / "o.csv", "--stats", folder / "s.json", "--tolerance", "1"})
                .status == 0);
    CHECK(Json::parse(content(folder / "s.json"))["tolerance_missed"] == 0);
    // So far out float64 boxes are rounded by 6e-11: these errors count as well.
    const std::string far =
        box_file<double>(folder, {1e6 + 0.1, 0, 0, 1e6 + 0.7, 1, 1, 1e6 + 0.3, 0, 0, 1e6 + 1, 1, 1});
    for (const char* const tolerance : {"1e-11", "1e-9"}) {
        REQUIRE(run_program({"contacts", far, "-o", folder / "o.csv", "--stats", folder / "s.json", "--tolerance",
                             tolerance, "--contacts-per-pair", "1"})
                    .status == 0);
        CHECK(Json::parse(content(folder / "s.json"))["tolerance_missed"] == (tolerance[3] == '1' ? 1 : 0));
    }
}

TEST_CASE("a scene on a device builds only the routines it needs", "[program]") {
    const TempFolder folder;
    std::string bodies;
    for (int i = 0; i < 200; ++i)
        bodies += std::string(i == 0 ? "" : ",") + R"({"shape": {"type": "sphere", "radius": 0.6}, "position": [)" +
                  std::to_string(i) + ", 0, 0]}";
    const std::string scene = folder.write("row.json", R"({"bodies": [)" + bodies + "]}");
    REQUIRE(run_program({"contacts", scene, "-o", folder / "o.csv", "--stats", folder / "s.json", "--devices", "0"},
                        {{"XDG_CACHE_HOME", folder / "cache"}})
                .status == 0);
    const Json stats = Json::parse(content(folder / "s.json"));
    CHECK(stats["contacts"] == 199);
    REQUIRE(stats["buckets"].size() == 1);
    CHECK(stats["buckets"][0]["pairs"] == 199);
    std::size_t routines = 0;
    for (const Json& module : stats["devices"][0]["kernels_built"]) {
        const std::string name = module.get<std::string>();
        CHECK_THAT(name, !Contains("convex"));
        if (name == "narrow_phase/sphere_sphere") ++routines;
    }
    CHECK(routines == 1);
    CHECK(stats["skipped"]["kernels_not_built"] > 10);
}

TEST_CASE("rejected boxes and bodies are left out of contacts, or refused", "[program]") {
    const TempFolder folder;
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    const std::string input =
        box_file<float>(folder, {0, 0, 0, 1, 1, 1, 0, nan, 0, 1, 1, 1, 3, 0, 0, 2, 1, 1, 0.5f, 0, 0, 2, 1, 1});
    const ProgramRun run =
        run_program({"contacts", input, "-o", "-", "--stats", folder / "s.json", "--contacts-per-pair", "1"});
    CHECK(run.status == 0);
    const std::vector<Row> rows = parse(run.out);
    REQUIRE(rows.size() == 1);
    CHECK(rows[0].b == 3);
    CHECK_THAT(run.err, Contains("body 1 is rejected: min y is nan and must be finite") &&
                            Contains("body 2 is rejected: min x is 3 and must be <= max x, which is 2"));
    const Json stats = Json::parse(content(folder / "s.json"));
    CHECK(stats["bodies"] == 4);
    CHECK(stats["rejected"][0] == Json({{"body", 1}, {"why", "min y is nan and must be finite"}}));
    folder.write("old.csv", "older\n");
    const ProgramRun strict = run_program({"contacts", input, "-o", folder / "old.csv", "--strict"});
    CHECK(strict.status == 2);
    CHECK_THAT(strict.err, Contains("body 1 is rejected"));
    CHECK(content(folder / "old.csv") == "older\n");
}

TEST_CASE("a mesh in a pair is refused by the input's name", "[program]") {
    const TempFolder folder;
    const std::string mesh = folder.write(
        "m.obj", "o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no b\nv 0.5 0 0\nv 1.5 0 0\nv 0.5 1 0\nf 4 5 6\n");
    const ProgramRun run = run_program({"contacts", mesh, "-o", folder / "o.csv"});
    CHECK(run.status == 2);
    CHECK_THAT(run.err, Contains("m.obj: the pair 0, 1 cannot be tested") && Contains("mesh"));
    CHECK(folder.names() == std::vector<std::string>{"m.obj"});
}
