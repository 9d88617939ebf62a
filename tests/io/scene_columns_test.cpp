// Scenes whose bodies come as columns of .npy files.
#include <catch2/catch.hpp>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "tests/io/npy_bytes.hpp"
#include "tests/io/temp_folder.hpp"
#include "tools/io/error.hpp"
#include "tools/io/scene_file.hpp"

namespace {

using namespace clinch::test;
using namespace clinch;
using Catch::Contains;
using io::LoadedScene;

const std::string ball = R"({"type": "sphere", "radius": 0.5})";
const std::string brick = R"({"type": "box", "half_extents": [1, 2, 3]})";

LoadedScene load(const TempFolder& folder, const std::string& text) {
    return io::read_scene(folder.write("s.json", text));
}

void write_columns(const TempFolder& folder) {
    folder.write("position.npy", npy("<f8", "(2, 3)", bytes<double>({0.1, 2, 3, 4, 5, 6})));
    folder.write("rotation.npy", npy("<f4", "(2, 4)", bytes<float>({1, 0, 0, 1, 0, 0, 0, 0}), 1, true));
    folder.write("velocity.npy", npy("<f4", "(2, 3)", bytes<float>({1, 2, 3, 4, 5, 6})));
    folder.write("spin.npy", npy("<f8", "(2, 3)", bytes<double>({7, 8, 9, 10, 11, 12})));
    folder.write("margin.npy", npy("<f4", "(2,)", bytes<float>({0, 0.5f})));
    folder.write("group.npy", npy("<u4", "(2,)", bytes<std::uint32_t>({1, 4294967295u})));
    folder.write("mask.npy", npy("<u4", "(2,)", bytes<std::uint32_t>({3, 0})));
    folder.write("motion.npy", npy("|u1", "(2,)", bytes<std::uint8_t>({0, 3})));
    folder.write("shape.npy", npy("<u4", "(2,)", bytes<std::uint32_t>({1, 0})));
}

}  // namespace

TEST_CASE("columns give every field, in the bodies or beside them", "[host]") {
    const TempFolder folder;
    write_columns(folder);
    const std::string columns =
        R"("columns": {"position": "position.npy", "rotation": "rotation.npy", "velocity": "velocity.npy",
        "angular_velocity": "spin.npy", "margin": "margin.npy", "group": "group.npy", "mask": "mask.npy",
        "motion": "motion.npy", "shape": "shape.npy"}, "shapes": [)" +
        ball + ", " + brick + "]";
    for (const std::string& text :
         {R"({"bodies": {"count": 2, )" + columns + "}}", R"({"bodies": {"count": 2}, )" + columns + "}"}) {
        INFO(text);
        const LoadedScene loaded = load(folder, text);
        REQUIRE(loaded.scene.row_count() == 2);
        CHECK(loaded.names.size() == 2);
        const Body a = loaded.scene.body({0}), b = loaded.scene.body({1});
        CHECK(std::holds_alternative<Box>(loaded.scene.shape(a.shape)));
        CHECK(std::holds_alternative<Sphere>(loaded.scene.shape(b.shape)));
        CHECK(a.pose.position.x == 0.1);
        CHECK(b.pose.position.z == 6.0);
        CHECK(a.pose.rotation.w == 1.0);
        CHECK(b.pose.rotation.w == 0.0);
        CHECK(b.pose.rotation.x == 1.0);
        CHECK(b.velocity.x == 4.0);
        CHECK(a.angular_velocity.y == 8.0);
        CHECK(a.margin == 0.0);
        CHECK(b.margin == 0.5);
        CHECK(b.group == 4294967295u);
        CHECK(a.mask == 3);
        CHECK(a.motion == Motion::Static);
        CHECK(b.motion == Motion::Sleeping);
    }
}

TEST_CASE("fields without a column have one value for all", "[host]") {
    const TempFolder folder;
    write_columns(folder);
    const LoadedScene loaded =
        load(folder, R"({"bodies": {"count": 2, "shape": )" + ball +
                         R"(, "position": [1, 2, 3], "motion": "kinematic", "group": 4, "margin": 0.125, "name": "n",
                         "columns": {"mask": "mask.npy"}}})");
    REQUIRE(loaded.scene.row_count() == 2);
    CHECK(loaded.names == std::vector<std::string>{"n", "n"});
    for (const std::uint32_t i : {0u, 1u}) {
        const Body body = loaded.scene.body({i});
        CHECK(body.pose.position.z == 3.0);
        CHECK(body.motion == Motion::Kinematic);
        CHECK(body.group == 4);
        CHECK(body.mask == (i == 0 ? 3u : 0u));
        CHECK(body.margin == 0.125);
    }
}

TEST_CASE("bodies of a meaningless shape of columns are rejected", "[host]") {
    const TempFolder folder;
    write_columns(folder);
    folder.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const LoadedScene loaded = load(
        folder, R"({"meshes": {"m": "m.obj"}, "bodies": {"count": 2, "columns": {"shape": "shape.npy"}, "shapes": [)" +
                    ball + R"(, {"type": "mesh", "mesh": "m", "scale": 0}]}})");
    const std::vector<Rejection> rejected = io::merge_rejections(loaded.scene.rejected(), loaded.reasons);
    REQUIRE(rejected.size() == 1);
    CHECK(rejected[0].body == 0);
    CHECK(rejected[0].why == "scale is 0 and must be > 0");
}

TEST_CASE("faults of columns name the file and the field", "[host]") {
    const TempFolder folder;
    write_columns(folder);
    folder.write("three.npy", npy("<f8", "(3, 3)", std::string(72, '\0')));
    folder.write("high.npy", npy("<u4", "(2,)", bytes<std::uint32_t>({0, 2})));
    folder.write("fast.npy", npy("|u1", "(2,)", bytes<std::uint8_t>({1, 4})));
    const auto document = [](const std::string& inside) { return R"({"bodies": {)" + inside + "}}"; };
    const auto columns = [&](const std::string& inside) {
        return document(R"("count": 2, "shape": )" + ball + R"(, "columns": {)" + inside + "}");
    };
    const std::string shape_column = R"("count": 2, "columns": {"shape": "high.npy"}, "shapes": [)" + ball + "]";
    struct Row {
        std::string text;
        const char* message;
    };
    const std::vector<Row> faults{
        {document(R"("shape": )" + ball), "bodies lacks the key count"},
        {document(R"("count": 2)"), "bodies lacks the key shape"},
        {document(R"("count": -1, "shape": )" + ball), "bodies.count is -1; a whole number"},
        {document(R"("count": 4294967296, "shape": )" + ball),
         "bodies.count is 4294967296; a whole number from 0 to 4294967295"},
        {document(R"("count": 2, "color": 1, "shape": )" + ball), "bodies.color is no known key"},
        {columns(R"("colour": "position.npy")"), "columns.colour is no known key"},
        {columns(R"("position": "three.npy")"), "columns.position is"},
        {columns(R"("position": "three.npy")"), "has 3 rows; bodies.count, 2"},
        {columns(R"("position": "none.npy")"), "none.npy: there is no such file"},
        {columns(R"("position": "rotation.npy")"), "rotation.npy: has the shape (2, 4); (n, 3)"},
        {columns(R"("position": 1)"), "columns.position is 1; a text"},
        {columns(R"("position": "position.npy", "position": "position.npy")"), "bodies.columns.position stands twice"},
        {columns(R"("group": "motion.npy")"), "motion.npy: has the type '|u1'"},
        {columns(R"("motion": "group.npy")"), "group.npy: has the type '<u4'"},
        {columns(R"("motion": "fast.npy")"), "fast.npy: row 1 is 4"},
        {columns(R"("shape": "shape.npy")"), "columns.shape is a column and one value for all"},
        {document(shape_column), "columns.shape: row 1 is 2 and shapes has 1 entries"},
        {document(R"("count": 2, "columns": {"shape": "shape.npy"})"), "lacks the key shape"},
        {document(R"("count": 2, "shapes": [], "shape": )" + ball), "bodies.shapes is given without a column shape"},
        {R"({"columns": {}, "bodies": {"count": 2, "columns": {}, "shape": )" + ball + "}}",
         "columns stands in bodies as well"},
    };
    for (const Row& fault : faults) {
        INFO(fault.text);
        CHECK_THROWS_AS(load(folder, fault.text), io::InputError);
        CHECK_THROWS_WITH(load(folder, fault.text), Contains(fault.message));
    }
}
