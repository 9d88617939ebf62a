#include "tools/draw/parts.hpp"

#include <algorithm>
#include <charconv>
#include <limits>

#include "tools/draw/vector.hpp"
#include "tools/io/error.hpp"
#include "tools/io/input_file.hpp"

namespace clinch::draw {

namespace {

constexpr double smooth_cosine = 0.80;  // faces that meet at less than 37 degrees look like one surface

// The mesh with smooth normals; its corners at one place are one vertex already.
std::vector<Triangle> smooth_triangles(const Mesh& mesh) {
    std::vector<Vec3> areas;  // a normal as long as twice the face's area
    areas.reserve(mesh.triangles.size());
    for (const auto& t : mesh.triangles) {
        const Vec3& a = mesh.vertices[t[0]];
        areas.push_back(cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a));
    }
    std::vector<std::vector<std::size_t>> faces(mesh.vertices.size());  // around each vertex
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
        for (const std::uint32_t v : mesh.triangles[f]) faces[v].push_back(f);
    std::vector<Triangle> triangles(mesh.triangles.size());
    for (std::size_t f = 0; f < triangles.size(); ++f) {
        const Vec3 own = unit(areas[f]);
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t v = mesh.triangles[f][c];
            Vec3 sum = areas[f];
            for (const std::size_t other : faces[v])
                if (other != f && dot(own, unit(areas[other])) > smooth_cosine) sum = sum + areas[other];
            triangles[f][c] = {mesh.vertices[v], unit(sum)};
        }
    }
    return triangles;
}

void include_point(Part& part, const Vec3& p) {
    part.min = {std::min(part.min.x, p.x), std::min(part.min.y, p.y), std::min(part.min.z, p.z)};
    part.max = {std::max(part.max.x, p.x), std::max(part.max.y, p.y), std::max(part.max.z, p.z)};
}

[[noreturn]] void wrong_line(const std::string& path, std::size_t line, const std::string& text) {
    throw io::InputError(path + ", line " + std::to_string(line) + ": found \"" + text +
                         "\"; accepted is the header \"a,b\" and then two indices of bodies in a line");
}

Pair parse_pair(const std::string& path, std::size_t line, const std::string& text, std::size_t count) {
    Pair pair{};
    const char* const end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, pair.a);
    if (first.ec != std::errc() || first.ptr == end || *first.ptr != ',') wrong_line(path, line, text);
    const auto second = std::from_chars(first.ptr + 1, end, pair.b);
    if (second.ec != std::errc() || second.ptr != end) wrong_line(path, line, text);
    if (std::max(pair.a, pair.b) >= count)
        throw io::InputError(path + ", line " + std::to_string(line) + ": found index " +
                             std::to_string(std::max(pair.a, pair.b)) + "; there are " + std::to_string(count) +
                             " bodies");
    return pair;
}

}  // namespace

std::vector<Part> make_parts(const std::vector<io::MeshNode>& nodes) {
    std::vector<Part> parts(nodes.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
        Part& part = parts[i];
        constexpr double far = std::numeric_limits<double>::infinity();
        part.min = {far, far, far};
        part.max = {-far, -far, -far};
        part.triangles = smooth_triangles(nodes[i].mesh);
        for (Triangle& triangle : part.triangles)
            for (Corner& corner : triangle) {
                corner.position = corner.position + nodes[i].centre;
                include_point(part, corner.position);
            }
    }
    return parts;
}

std::vector<Pair> read_pairs(const std::string& path, std::size_t count) {
    const std::string text = io::read_text(path);
    std::vector<Pair> pairs;
    std::size_t line = 0;
    for (std::size_t start = 0; start < text.size();) {
        const std::size_t end = std::min(text.find('\n', start), text.size());
        const std::string row = text.substr(start, end - start);
        if (++line > 1)
            pairs.push_back(parse_pair(path, line, row, count));
        else if (row != "a,b")
            wrong_line(path, line, row);
        start = end + 1;
    }
    if (line == 0) wrong_line(path, 1, "");
    return pairs;
}

std::vector<std::uint32_t> partners(const std::vector<Pair>& pairs, std::uint32_t body) {
    std::vector<std::uint32_t> found;
    for (const Pair& pair : pairs)
        if (pair.a == body || pair.b == body) found.push_back(pair.a == body ? pair.b : pair.a);
    return found;
}

}  // namespace clinch::draw
