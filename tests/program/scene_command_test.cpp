// clinch scene writes what the generators make.
#include <catch2/catch.hpp>
#include <cstring>
#include <string>
#include <vector>

#include "bench/scenes/boxes.hpp"
#include "tests/io/npy_bytes.hpp"
#include "tests/program/run_program.hpp"

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
