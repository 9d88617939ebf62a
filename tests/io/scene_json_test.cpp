// Scene .json files: what every field means, and every fault that is refused.
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
using io::InputError;
using io::LoadedScene;
using io::read_scene;

const char* const triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const std::string ball = R"({"type": "sphere", "radius": 0.5})";

LoadedScene load(const TempFolder& folder, const std::string& text) {
    return read_scene(folder.write("s.json", text));
}

/// The document with one body of this shape.
std::string with_shape(const std::string& shape) {
    return R"({"bodies": [{"shape": )" + shape + "}]}";
}
/// The document with one ball that has these fields as well.
std::string with_fields(const std::string& fields) {
    return R"({"bodies": [{"shape": )" + ball + ", " + fields + "}]}";
}

template <class T>
T shape_of(const LoadedScene& loaded, std::uint32_t body) {
    return std::get<T>(loaded.scene.shape(loaded.scene.body({body}).shape));
}

}  // namespace

TEST_CASE("a scene file gives every field of a body", "[host]") {
    const TempFolder folder;
    const LoadedScene loaded = load(folder, R"({"bodies": [{"name": "a", "shape": {"type": "sphere", "radius": 0.1},
        "position": [1e7, 0.1, -3], "rotation": [0, 1, 0, 0], "velocity": [1, 2, 3], "angular_velocity": [4, 5, 6],
        "motion": "sleeping", "group": 6, "mask": 4294967295, "margin": 0.25}, {"shape": {"type": "sphere", "radius": 2}}]})");
    REQUIRE(loaded.scene.row_count() == 2);
    CHECK(loaded.names == std::vector<std::string>{"a", ""});
    const Body a = loaded.scene.body({0});
    CHECK(shape_of<Sphere>(loaded, 0).radius == 0.1);
    CHECK(a.pose.position.x == 1e7);
    CHECK(a.pose.position.y == 0.1);
    CHECK(a.pose.rotation.w == 0.0);
    CHECK(a.pose.rotation.x == 1.0);
    CHECK(a.velocity.z == 3.0);
    CHECK(a.angular_velocity.y == 5.0);
    CHECK(a.motion == Motion::Sleeping);
    CHECK(a.group == 6);
    CHECK(a.mask == 4294967295u);
    CHECK(a.margin == 0.25);
    const Body b = loaded.scene.body({1});
    CHECK(b.pose.position.x == 0.0);
    CHECK(b.pose.rotation.w == 1.0);
    CHECK(b.motion == Motion::Dynamic);
    CHECK(b.group == 1);
    CHECK(b.mask == 4294967295u);
    CHECK(b.margin == 0.0);
    CHECK(loaded.scene.rejected().empty());
    CHECK(loaded.reasons.empty());
}

TEST_CASE("a scene file gives every shape, equal ones once", "[host]") {
    const TempFolder folder;
    folder.write("bolt.obj", triangle);
    const LoadedScene loaded = load(folder, R"({"meshes": {"bolt": "bolt.obj", "same": "./bolt.obj"}, "bodies": [
        {"shape": {"type": "box", "half_extents": [1, 2, 3]}},
        {"shape": {"type": "capsule", "radius": 0.2, "half_height": 0}},
        {"shape": {"type": "cylinder", "radius": 0.2, "half_height": 0.5}},
        {"shape": {"type": "cone", "half_height": 0.5, "radius": 0.2}},
        {"shape": {"type": "plane", "normal": [0, 0, 1], "offset": -2.5}},
        {"shape": {"type": "hull", "points": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]]}},
        {"shape": {"type": "mesh", "mesh": "bolt", "scale": 3}},
        {"shape": {"type": "mesh", "mesh": "same", "scale": 3.0}},
        {"shape": {"type": "mesh", "mesh": "bolt"}},
        {"shape": {"type": "box", "half_extents": [1, 2, 3.0]}}]})");
    REQUIRE(loaded.scene.row_count() == 10);
    CHECK(loaded.scene.shape_count() == 8);
    CHECK(shape_of<Box>(loaded, 0).half_extents.z == 3.0);
    CHECK(shape_of<Capsule>(loaded, 1).half_height == 0.0);
    CHECK(shape_of<Cylinder>(loaded, 2).radius == 0.2);
    CHECK(shape_of<Cone>(loaded, 3).half_height == 0.5);
    CHECK(shape_of<Plane>(loaded, 4).offset == -2.5);
    CHECK(shape_of<Hull>(loaded, 5).points[3].z == 1.0);
    CHECK(shape_of<Mesh>(loaded, 6).vertices[1].x == 3.0);
    CHECK(shape_of<Mesh>(loaded, 8).vertices[1].x == 1.0);
    const auto id = [&](std::uint32_t body) { return loaded.scene.body({body}).shape.index; };
    CHECK(id(0) == id(9));
    CHECK(id(6) == id(7));
    CHECK(id(6) != id(8));
    CHECK(loaded.scene.rejected().empty());
}

TEST_CASE("empty scenes are valid", "[host]") {
    const TempFolder folder;
    folder.write("none.npy", npy("<f8", "(0, 3)", ""));
    for (const char* const text : {R"({"bodies": []})", R"({"bodies": {"count": 0}})",
                                   R"({"bodies": {"count": 0, "columns": {"position": "none.npy"}}})"}) {
        INFO(text);
        CHECK(load(folder, text).scene.row_count() == 0);
    }
}

TEST_CASE("meaningless bodies are rejected and the others stay", "[host]") {
    const TempFolder folder;
    folder.write("bolt.obj", triangle);
    folder.write("points.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n");
    const LoadedScene loaded = load(folder, R"({"meshes": {"bolt": "bolt.obj", "points": "points.obj"}, "bodies": [
        {"shape": {"type": "sphere", "radius": 1}},
        {"shape": {"type": "sphere", "radius": 0}},
        {"shape": {"type": "mesh", "mesh": "bolt", "scale": 0}},
        {"shape": {"type": "mesh", "mesh": "bolt", "scale": -1}},
        {"shape": {"type": "mesh", "mesh": "points"}},
        {"shape": {"type": "sphere", "radius": 1}, "rotation": [2, 0, 0, 0]},
        {"shape": {"type": "sphere", "radius": 1}, "margin": -1},
        {"shape": {"type": "hull", "points": []}},
        {"shape": {"type": "sphere", "radius": 1}}]})");
    const std::vector<Rejection> rejected = io::merge_rejections(loaded.scene.rejected(), loaded.reasons);
    std::vector<std::uint32_t> bodies;
    bodies.reserve(rejected.size());
    for (const Rejection& r : rejected) bodies.push_back(r.body);
    CHECK(bodies == std::vector<std::uint32_t>{1, 2, 3, 4, 5, 6, 7});
    CHECK(rejected[1].why == "scale is 0 and must be > 0");
    CHECK(rejected[2].why == "scale is -1 and must be > 0");
    CHECK_THAT(rejected[3].why, Contains("triangle"));
}

TEST_CASE("structural faults of a scene file name their place", "[host]") {
    const TempFolder folder;
    folder.write("bolt.obj", triangle);
    folder.write("text.txt", triangle);
    struct Row {
        std::string text;
        const char* message;
    };
    const std::vector<Row> faults{
        {"", "no JSON document"},
        {"{", "no JSON document"},
        {"[]", "the document is a list of 0; an object"},
        {R"({"bodies": []} x)", "no JSON document"},
        {R"({"bodies": [], // none
})",
         "no JSON document"},
        {"{}", "lacks the key bodies"},
        {R"({"bodies": 3})", "bodies is neither a list"},
        {R"({"bodies": [], "boddies": []})", "boddies is no known key; meshes, bodies, columns, shapes are accepted"},
        {R"({"bodies": [], "bodies": []})", "bodies stands twice"},
        {R"({"bodies": [[]]})", "bodies[0] is a list of 0; an object"},
        {R"({"bodies": [{}]})", "bodies[0] lacks the key shape"},
        {with_shape("3"), "bodies[0].shape is 3; an object"},
        {with_shape("{}"), "bodies[0].shape lacks the key type"},
        {with_shape(R"({"type": "ball", "radius": 1})"), "bodies[0].shape.type is 'ball'; sphere, box"},
        {with_shape(R"({"type": 4})"), "bodies[0].shape.type is 4; a text"},
        {with_shape(R"({"type": "sphere", "radus": 1})"),
         "bodies[0].shape.radus is no known key; type, radius are accepted"},
        {with_shape(R"({"type": "sphere"})"), "bodies[0].shape lacks the key radius"},
        {with_shape(R"({"type": "sphere", "radius": "1"})"), "bodies[0].shape.radius is \"1\"; a number"},
        {with_shape(R"({"type": "sphere", "radius": null})"), "radius is null; a number"},
        {with_shape(R"({"type": "sphere", "radius": NaN})"), "no JSON document"},
        {with_shape(R"({"type": "sphere", "radius": Infinity})"), "no JSON document"},
        {with_shape(R"({"type": "sphere", "radius": 1e999})"), "no JSON document"},
        {with_shape(R"({"type": "sphere", "radius": 1, "radius": 1})"), "bodies[0].shape.radius stands twice"},
        {with_shape(R"({"type": "box", "half_extents": [1, 1]})"),
         "half_extents is a list of 2; a list of 3 numbers, x y z"},
        {with_shape(R"({"type": "box", "half_extents": [1, 1, "a"]})"), "half_extents[2] is \"a\"; a number"},
        {with_shape(R"({"type": "hull", "points": [[0,0,0],[1,0]]})"), "bodies[0].shape.points[1] is a list of 2"},
        {with_shape(R"({"type": "hull", "points": {}})"), "points is an object; a list"},
        {with_shape(R"({"type": "mesh", "mesh": "bolt"})"), "mesh is 'bolt'; a name that stands in meshes"},
        {with_fields(R"("colour": 1)"), "bodies[0].colour is no known key"},
        {with_fields(R"("position": [1, 2, 3], "position": [1, 2, 3])"), "bodies[0].position stands twice"},
        {with_fields(R"("rotation": [1, 2, 3])"), "bodies[0].rotation is a list of 3; a list of 4 numbers, w x y z"},
        {with_fields(R"("motion": "fixed")"), "bodies[0].motion is 'fixed'; static, kinematic, dynamic and sleeping"},
        {with_fields(R"("group": -1)"), "bodies[0].group is -1; a whole number from 0 to 4294967295"},
        {with_fields(R"("group": 1.5)"), "group is 1.5; a whole number"},
        {with_fields(R"("mask": 4294967296)"), "mask is 4294967296; a whole number"},
        {with_fields(R"("margin": [])"), "bodies[0].margin is a list of 0; a number"},
        {with_fields(R"("name": 1)"), "bodies[0].name is 1; a text"},
        {R"({"meshes": [], "bodies": []})", "meshes must be an object"},
        {R"({"meshes": {"a": 1}, "bodies": []})", "meshes.a is 1; a text"},
        {R"({"meshes": {"a": "none.obj"}, "bodies": []})", "meshes.a is 'none.obj' and there is no file"},
        {R"({"meshes": {"a": "text.txt"}, "bodies": []})",
         "meshes.a is 'text.txt'; a file with one of the endings .glb"},
        {R"({"meshes": {"a": "bolt.obj", "a": "bolt.obj"}, "bodies": []})", "meshes.a stands twice"},
        {R"({"bodies": [], "columns": {}})", "columns goes with bodies as an object"},
        {R"({"bodies": [], "shapes": []})", "shapes goes with bodies as an object"},
    };
    for (const Row& fault : faults) {
        INFO(fault.text);
        CHECK_THROWS_AS(load(folder, fault.text), InputError);
        CHECK_THROWS_WITH(load(folder, fault.text), Contains("s.json: ") && Contains(fault.message));
    }
    CHECK_THROWS_WITH(read_scene(folder / "none.json"), Contains("none.json: there is no such file"));
    CHECK_THROWS_WITH(read_scene(folder / "text.txt"), Contains("ending '.txt'"));
}

TEST_CASE("duplicate keys are found at any depth", "[host]") {
    const TempFolder folder;
    const std::string text =
        R"({"bodies": [{"shape": {"type": "sphere", "radius": 1}, "position": [[], [1], {"x": [3, {"y": 1, "y": 2}]}]}]})";
    CHECK_THROWS_WITH(load(folder, text), Contains("bodies[0].position[2].x[1].y stands twice"));
}

TEST_CASE("a mesh file that cannot be read is named", "[host]") {
    const TempFolder folder;
    folder.write("bad.obj", "v 0 0 0\nf 1 2 9\n");
    CHECK_THROWS_WITH(
        load(folder, R"({"meshes": {"a": "bad.obj"}, "bodies": [{"shape": {"type": "mesh", "mesh": "a"}}]})"),
        Contains("bad.obj: cannot be read"));
    // Not used, not read.
    CHECK(load(folder, R"({"meshes": {"a": "bad.obj"}, "bodies": []})").scene.row_count() == 0);
}
