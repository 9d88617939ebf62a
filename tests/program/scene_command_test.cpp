// clinch scene writes what the generators make.
#include <catch2/catch.hpp>
#include <cstring>
#include <string>
#include <vector>

#include "bench/scenes/bodies.hpp"
#include "bench/scenes/boxes.hpp"
#include "tests/io/npy_bytes.hpp"
#include "tests/program/run_program.hpp"
#include "tools/io/scene_file.hpp"

TEST_CASE("generated scenes are written box for box", "[program]") {
    using namespace clinch::test;
    const TempFolder folder;
    for (const clinch::scenes::BoxKind& kind : clinch::scenes::box_kinds())
        for (const std::size_t count : {0u, 1u, 5000u}) {
            INFO(kind.name << ' ' << count);
            const ProgramRun run = run_program({"scene", kind.name, "--count", std::to_string(count), "--seed",
                                                "18446744073709551615", "-o", folder / "s.npy"});
            CHECK(run.status == 0);
            CHECK(run.out.empty());
            CHECK(run.err.empty());
            const std::string data = bytes(clinch::scenes::make_boxes(kind.name, count, 18446744073709551615u));
            CHECK(content(folder / "s.npy") == npy("<f4", "(" + std::to_string(count) + ", 6)", data));
        }
    CHECK(folder.names() == std::vector<std::string>{"s.npy"});
}

TEST_CASE("generated scenes of bodies are written body for body", "[program]") {
    using namespace clinch::test;
    const TempFolder folder;
    for (const clinch::scenes::BodyKind& kind : clinch::scenes::body_kinds())
        for (const std::size_t count : {0u, 1u, 300u}) {
            INFO(kind.name << ' ' << count);
            const ProgramRun run = run_program(
                {"scene", kind.name, "--count", std::to_string(count), "--seed", "12", "-o", folder / "s.json"});
            CHECK(run.status == 0);
            CHECK(run.out.empty());
            CHECK(run.err.empty());
            const clinch::Scene expected = clinch::scenes::make_bodies(kind.name, count, 12);
            const clinch::Scene read = clinch::io::read_scene(folder / "s.json").scene;
            REQUIRE(read.row_count() == count);
            for (std::uint32_t i = 0; i < count; ++i) {
                const clinch::Body was = expected.body({i}), is = read.body({i});
                CHECK(std::memcmp(&was.pose, &is.pose, sizeof was.pose) == 0);
                CHECK(was.motion == is.motion);
                CHECK(expected.shape(was.shape).index() == read.shape(is.shape).index());
            }
        }
    CHECK(folder.names() == std::vector<std::string>{"s.json"});
}
