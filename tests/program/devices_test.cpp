// clinch devices, and what happens where there is no OpenCL at all.
#include <catch2/catch.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "clinch/device.hpp"
#include "tests/io/npy_bytes.hpp"
#include "tests/program/run_program.hpp"

namespace {

using namespace clinch::test;
using Catch::Contains;
using Json = nlohmann::json;

const std::map<std::string, std::string> no_opencl{{"OCL_ICD_VENDORS", "/nonexistent"}, {"OCL_ICD_FILENAMES", ""}};

}  // namespace

TEST_CASE("devices are listed as a table and as JSON", "[program]") {
    const auto devices = clinch::list_devices();
    REQUIRE_FALSE(devices.empty());
    const ProgramRun table = run_program({"devices"});
    CHECK(table.status == 0);
    CHECK_THAT(table.out, Contains("index") && Contains("use"));
    const ProgramRun json = run_program({"devices", "--json"});
    CHECK(json.status == 0);
    const Json list = Json::parse(json.out);
    REQUIRE(list.size() == devices.size());
    for (std::size_t i = 0; i < devices.size(); ++i) {
        CHECK_THAT(table.out, Contains(devices[i].name) && Contains(devices[i].use));
        CHECK(list[i]["index"] == devices[i].index);
        CHECK(list[i]["name"] == devices[i].name);
        CHECK(list[i]["platform"] == devices[i].platform);
        CHECK(list[i]["type"] == clinch::to_string(devices[i].type));
        CHECK(list[i]["compute_units"] == devices[i].compute_units);
        CHECK(list[i]["lanes"] == devices[i].lanes);
        CHECK(list[i]["global_memory"] == devices[i].global_memory);
        CHECK(list[i]["fp64"] == devices[i].fp64);
        CHECK(list[i]["quirks"] == devices[i].quirks);
        CHECK(list[i]["use"] == devices[i].use);
    }
}

TEST_CASE("without OpenCL the program says what to install, and the host still works", "[program]") {
    const TempFolder folder;
    const std::string input =
        folder.write("b.npy", npy("<f4", "(2, 6)", bytes<float>({0, 0, 0, 1, 1, 1, 0, 0, 0, 1, 1, 1})));
    const ProgramRun devices = run_program({"devices"}, no_opencl);
    CHECK(devices.status == 1);
    CHECK_THAT(devices.out, Contains("index"));
    CHECK_THAT(devices.err, Contains("pocl-opencl-icd"));
    const ProgramRun json = run_program({"devices", "--json"}, no_opencl);
    CHECK(json.status == 1);
    CHECK(Json::parse(json.out).empty());

    const ProgramRun device = run_program({"pairs", input, "-o", "-"}, no_opencl);
    CHECK(device.status == 1);
    CHECK(device.out.empty());
    CHECK_THAT(device.err, Contains("no OpenCL") && Contains("pocl-opencl-icd"));
    const ProgramRun host =
        run_program({"pairs", input, "-o", "-", "--algorithm", "host-brute", "--stats", folder / "s.json"}, no_opencl);
    CHECK(host.status == 0);
    CHECK(host.out == "a,b\n0,1\n");
    CHECK(Json::parse(content(folder / "s.json"))["devices"].empty());
    CHECK(run_program({"scene", "density", "--count", "10", "-o", folder / "d.npy"}, no_opencl).status == 0);
}

TEST_CASE("CLINCH_DEVICES narrows the devices", "[program]") {
    const TempFolder folder;
    const std::string input = folder.write("b.npy", npy("<f4", "(0, 6)", ""));
    const ProgramRun wrong = run_program({"pairs", input, "-o", "-"}, {{"CLINCH_DEVICES", "nothing"}});
    CHECK(wrong.status == 2);
    CHECK_THAT(wrong.err, Contains("CLINCH_DEVICES is 'nothing'"));
    const ProgramRun none = run_program({"pairs", input, "-o", "-"}, {{"CLINCH_DEVICES", "99"}});
    CHECK(none.status == 1);
    CHECK_THAT(none.err, Contains("CLINCH_DEVICES '99'"));
}
