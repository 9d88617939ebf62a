// Mesh files through the importer: nodes, transforms, triangles and faults.
#include "tools/io/mesh_file.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tests/io/npy_bytes.hpp"
#include "tests/io/temp_folder.hpp"
#include "tools/io/error.hpp"

namespace {

using namespace clinch::test;
using Catch::Contains;
using clinch::Vec3;
using clinch::io::InputError;
using clinch::io::MeshNode;
using clinch::io::read_mesh;
using clinch::io::read_mesh_nodes;

const char* const two_objects =
    "o slab\nv 10 0 0\nv 14 0 0\nv 14 2 0\nv 10 2 0\nf 1 2 3 4\n"
    "o flag\nv 0 0 5\nv 1 0 5\nv 0 1 7\nf 5 6 7\n";

/// A triangle (0 0 0) (0.1 0 0) (0 1 0), once on a node moved by 1e6 and turned by a quarter about z below
/// one that is scaled by 2, and once more on a node of its own.
std::string gltf(const std::string& bin = "t.bin", int corners = 3) {
    const std::string count = std::to_string(corners), index_bytes = std::to_string(4 * corners);
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,2]}],
 "nodes":[{"name":"top","children":[1],"scale":[2,2,2]},
          {"name":"moved","mesh":0,"translation":[1000000,0,0],"rotation":[0,0,0.70710678118654752,0.70710678118654752]},
          {"name":"plain","mesh":0}],
 "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
 "buffers":[{"uri":")" +
           bin + R"(","byteLength":)" + std::to_string(36 + 4 * corners) + R"(}],
 "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":)" +
           index_bytes + R"(}],
 "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[0.1,1,0]},
              {"bufferView":1,"componentType":5125,"count":)" +
           count + R"(,"type":"SCALAR"}]})";
}

std::string gltf_data(const std::vector<std::uint32_t>& indices) {
    return bytes<float>({0, 0, 0, 0.1f, 0, 0, 0, 1, 0}) + bytes(indices);
}

void check_near(const Vec3& found, const Vec3& expected, double tolerance) {
    INFO(found.x << ' ' << found.y << ' ' << found.z);
    CHECK(found.x == Approx(expected.x).margin(tolerance));
    CHECK(found.y == Approx(expected.y).margin(tolerance));
    CHECK(found.z == Approx(expected.z).margin(tolerance));
}

}  // namespace

TEST_CASE("each node of a mesh file is placed at the middle of its bounds", "[host]") {
    const TempFolder folder;
    const std::vector<MeshNode> nodes = read_mesh_nodes(folder.write("two.obj", two_objects));
    REQUIRE(nodes.size() == 2);
    CHECK(nodes[0].name == "slab");
    CHECK(nodes[1].name == "flag");
    check_near(nodes[0].centre, {12, 1, 0}, 0.0);
    check_near(nodes[1].centre, {0.5, 0.5, 6}, 0.0);
    CHECK(nodes[0].mesh.vertices.size() == 4);
    CHECK(nodes[0].mesh.triangles.size() == 2);
    CHECK(nodes[1].mesh.triangles.size() == 1);
    for (const Vec3& v : nodes[0].mesh.vertices) {
        CHECK(std::abs(v.x) == 2.0);
        CHECK(std::abs(v.y) == 1.0);
        CHECK(v.z == 0.0);
    }
    const clinch::Mesh whole = read_mesh(folder / "two.obj");
    CHECK(whole.vertices.size() == 7);
    CHECK(whole.triangles.size() == 3);
    const auto top = std::max_element(whole.vertices.begin(), whole.vertices.end(),
                                      [](const Vec3& p, const Vec3& q) { return p.z < q.z; });
    check_near(*top, {0, 1, 7}, 0.0);
}

TEST_CASE("transforms of nested nodes are put together in float64", "[host]") {
    const TempFolder folder;
    folder.write("t.bin", gltf_data({0, 1, 2}));
    const std::vector<MeshNode> nodes = read_mesh_nodes(folder.write("t.gltf", gltf()));
    REQUIRE(nodes.size() == 2);
    CHECK(nodes[0].name == "moved");
    CHECK(nodes[1].name == "plain");
    // Turned: x to y and y to -x; then moved and scaled. Float32 would keep no more than 1/8 there.
    const double side = double{0.1f};
    check_near(nodes[0].centre, {2e6 - 1.0, side, 0}, 1e-6);
    REQUIRE(nodes[0].mesh.vertices.size() == 3);
    check_near(nodes[0].mesh.vertices[1], {1.0, side, 0}, 1e-6);
    check_near(nodes[0].mesh.vertices[2], {-1.0, -side, 0}, 1e-6);
    check_near(nodes[1].centre, {0.5 * side, 0.5, 0}, 0.0);
}

TEST_CASE("corners at one place become one vertex, but no two near ones", "[host]") {
    const TempFolder folder;
    std::string stl = "solid box\n";
    const auto facet = [&](const std::string& a, const std::string& b, const std::string& c) {
        stl +=
            "facet normal 0 0 1\nouter loop\nvertex " + a + "\nvertex " + b + "\nvertex " + c + "\nendloop\nendfacet\n";
    };
    facet("0 0 0", "1 0 0", "1 1 0");
    facet("0 0 0", "1 1 0", "0 1 0");
    facet("-0 0 0", "1.0000001 1 0", "0 1 0");
    const std::vector<MeshNode> nodes = read_mesh_nodes(folder.write("box.STL", stl + "endsolid box\n"));
    REQUIRE(nodes.size() == 1);
    CHECK(nodes[0].mesh.triangles.size() == 3);
    CHECK(nodes[0].mesh.vertices.size() == 5);
}

TEST_CASE("every ending is read", "[host]") {
    const TempFolder folder;
    const char* const dae = R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="half" meter="0.5"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 4 0 0 0 8 0</float_array><technique_common>
<accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>
</technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n" name="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
    const char* const ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n2 0 0\n0 4 0\n3 0 1 2\n";
    const std::string json =
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36}],)"
        R"("bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,)"
        R"("componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[2,4,0]}]})";
    const std::string padded = json + std::string((4 - json.size() % 4) % 4, ' ');
    const auto word = [](std::size_t n) { return bytes<std::uint32_t>({static_cast<std::uint32_t>(n)}); };
    const std::string glb = "glTF" + word(2) + word(12 + 8 + padded.size() + 8 + 36) + word(padded.size()) + "JSON" +
                            padded + word(36) + std::string("BIN\0", 4) + bytes<float>({0, 0, 0, 2, 0, 0, 0, 4, 0});
    const std::vector<std::pair<std::string, std::string>> files{
        {"a.obj", "v 0 0 0\nv 2 0 0\nv 0 4 0\nf 1 2 3\n"},
        {"a.off", "OFF\n3 1 0\n0 0 0\n2 0 0\n0 4 0\n3 0 1 2\n"},
        {"a.stl",
         "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 4 "
         "0\nendloop\nendfacet\nendsolid a\n"},
        {"a.ply", ply},
        {"a.dae", dae},
        {"a.glb", glb}};
    for (const auto& [name, text] : files) {
        INFO(name);
        CHECK(clinch::io::is_mesh_path(name));
        const std::vector<MeshNode> nodes = read_mesh_nodes(folder.write(name, text));
        REQUIRE(nodes.size() == 1);
        CHECK(nodes[0].mesh.triangles.size() == 1);
        CHECK(nodes[0].mesh.vertices.size() == 3);
        check_near(nodes[0].centre, {1, 2, 0}, 0.0);
    }
    CHECK(clinch::io::is_mesh_path("a.gltf"));
    CHECK_FALSE(clinch::io::is_mesh_path("a.json"));
    CHECK_FALSE(clinch::io::is_mesh_path("obj"));
}

TEST_CASE("points and lines give a node without triangles", "[host]") {
    const TempFolder folder;
    const char* const points =
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
        "0 0 0\n1 1 1\n";
    for (const auto& [name, text] :
         {std::pair<std::string, std::string>{"p.ply", points},
          std::pair<std::string, std::string>{"l.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2 3\n"}}) {
        INFO(name);
        const std::vector<MeshNode> nodes = read_mesh_nodes(folder.write(name, text));
        REQUIRE(nodes.size() == 1);
        CHECK(nodes[0].mesh.triangles.empty());
        CHECK(nodes[0].mesh.vertices.empty());
        check_near(nodes[0].centre, {0, 0, 0}, 0.0);
    }
}

TEST_CASE("no corner of a polygon is lost, not even of one that crosses itself", "[host]") {
    const TempFolder folder;
    const std::string vertices = "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nv 5 5 0\nv 3 0 1\n";
    const std::vector<MeshNode> nodes = read_mesh_nodes(folder.write("x.obj", vertices + "f 1 2 3 4\nf 1 2 3 4 5 6\n"));
    REQUIRE(nodes.size() == 1);
    CHECK(nodes[0].mesh.vertices.size() == 6);
    CHECK(nodes[0].mesh.triangles.size() == 6);
}

TEST_CASE("faults of a mesh file are errors that name it", "[host]") {
    const TempFolder folder;
    folder.write("t.bin", gltf_data({0, 1, 2, 0, 1, 7}));
    folder.write("short.bin", "x");
    struct Row {
        const char* name;
        std::string text;
        const char* message;
    };
    const std::vector<Row> faults{
        {"empty.obj", "", "is empty"},
        {"noise.glb", "no glTF at all", "cannot be read as a .glb mesh file"},
        {"noise.stl", std::string(200, '\x7f'), "cannot be read as a .stl"},
        {"index.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n", "index"},
        {"index.gltf", gltf("t.bin", 6), "out-of-range indices"},
        {"bin.gltf", gltf("none.bin"), "none.bin"},
        {"short.gltf", gltf("short.bin"), "cannot be read as a .gltf"},
        {"count.off", "OFF\n3 2 0\n0 0 0\n2 0 0\n0 4 0\n3 0 1 2\n", "faces in the header"},
    };
    for (const Row& fault : faults) {
        INFO(fault.name);
        const std::string path = folder.write(fault.name, fault.text);
        CHECK_THROWS_AS(read_mesh_nodes(path), InputError);
        CHECK_THROWS_WITH(read_mesh_nodes(path), Contains(path) && Contains(fault.message));
        CHECK_THROWS_AS(read_mesh(path), InputError);
    }
    CHECK_THROWS_WITH(read_mesh_nodes(folder / "none.obj"), Contains("none.obj: there is no such file"));
    CHECK_THROWS_WITH(read_mesh_nodes(folder.path().string() + "/"), Contains("no regular file"));
}
