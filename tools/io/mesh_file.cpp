#include "tools/io/mesh_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <unordered_map>
#include <utility>

#include "tools/io/mesh_import.hpp"
#include "tools/io/text.hpp"

namespace clinch::io {
namespace {

/// Rotation, scale and shift in float64: the upper three rows of a 4 x 4 matrix.
struct Transform {
    std::array<std::array<double, 4>, 3> m{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

    Vec3 operator()(const aiVector3D& v) const {
        const auto row = [&](const std::array<double, 4>& r) {
            return r[0] * double{v.x} + r[1] * double{v.y} + r[2] * double{v.z} + r[3];
        };
        return {row(m[0]), row(m[1]), row(m[2])};
    }
    /// First `local`, then this.
    Transform operator*(const aiMatrix4x4& local) const {
        Transform product;
        for (std::size_t i = 0; i < 3; ++i)
            for (unsigned j = 0; j < 4; ++j) {
                double sum = j == 3 ? m[i][3] : 0.0;
                for (unsigned k = 0; k < 3; ++k) sum += m[i][k] * double{local[k][j]};
                product.m[i][j] = sum;
            }
        return product;
    }
};

/// Gives corners at exactly one place one number, and only corners that a triangle uses.
class Welder {
public:
    explicit Welder(Mesh& mesh) : mesh_(mesh) {}

    std::uint32_t vertex(const Vec3& p) {
        const Vec3 key{p.x + 0.0, p.y + 0.0, p.z + 0.0};  // -0 is 0
        const auto [entry, added] = numbers_.try_emplace(key, static_cast<std::uint32_t>(mesh_.vertices.size()));
        if (added) mesh_.vertices.push_back(key);
        return entry->second;
    }

private:
    struct Hash {
        std::size_t operator()(const Vec3& p) const noexcept {
            std::uint64_t hash = 0;
            for (const double c : {p.x, p.y, p.z}) {
                std::uint64_t bits = 0;
                std::memcpy(&bits, &c, sizeof bits);
                hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
                hash ^= hash >> 32;
            }
            return static_cast<std::size_t>(hash);
        }
    };
    struct Same {
        bool operator()(const Vec3& p, const Vec3& q) const noexcept { return p.x == q.x && p.y == q.y && p.z == q.z; }
    };
    Mesh& mesh_;
    std::unordered_map<Vec3, std::uint32_t, Hash, Same> numbers_;
};

void add_mesh(const aiMesh& source, const Transform& to_world, Welder& welder, Mesh& mesh) {
    for (unsigned f = 0; f < source.mNumFaces; ++f) {
        const aiFace& face = source.mFaces[f];
        const auto corner = [&](unsigned k) { return welder.vertex(to_world(source.mVertices[face.mIndices[k]])); };
        // Points and lines give nothing; a polygon that the importer could not split becomes a fan.
        for (unsigned k = 2; k < face.mNumIndices; ++k) mesh.triangles.push_back({corner(0), corner(k - 1), corner(k)});
    }
}

/// Calls visit(node, transform to world) for every node that bears a mesh, depth first. Keeps its own
/// stack: a file may nest deeper than the machine's.
template <class Visit>
void visit_nodes(const aiScene& scene, const Visit& visit) {
    std::vector<std::pair<const aiNode*, Transform>> stack;
    if (scene.mRootNode != nullptr) stack.emplace_back(scene.mRootNode, Transform{});
    while (!stack.empty()) {
        const auto [node, above] = stack.back();
        stack.pop_back();
        const Transform to_world = above * node->mTransformation;
        if (node->mNumMeshes > 0) visit(*node, to_world);
        for (unsigned i = node->mNumChildren; i > 0; --i) stack.emplace_back(node->mChildren[i - 1], to_world);
    }
}

void add_node(const aiScene& scene, const aiNode& node, const Transform& to_world, Welder& welder, Mesh& mesh) {
    for (unsigned i = 0; i < node.mNumMeshes; ++i) add_mesh(*scene.mMeshes[node.mMeshes[i]], to_world, welder, mesh);
}

/// Moves a node's vertices so that the middle of their bounds is the origin.
void centre(MeshNode& node) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Vec3 low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
    for (const Vec3& v : node.mesh.vertices) {
        low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
        high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
    }
    const Vec3 middle{0.5 * low.x + 0.5 * high.x, 0.5 * low.y + 0.5 * high.y, 0.5 * low.z + 0.5 * high.z};
    // No vertex, or one that is not finite: the body will be rejected, with its vertices as they are.
    if (!std::isfinite(middle.x) || !std::isfinite(middle.y) || !std::isfinite(middle.z)) return;
    node.centre = middle;
    for (Vec3& v : node.mesh.vertices) v = {v.x - middle.x, v.y - middle.y, v.z - middle.z};
}

}  // namespace

const std::vector<std::string>& mesh_endings() {
    static const std::vector<std::string> endings{".glb", ".gltf", ".obj", ".stl", ".ply", ".dae", ".off"};
    return endings;
}

bool is_mesh_path(const std::string& path) {
    const std::vector<std::string>& all = mesh_endings();
    return std::find(all.begin(), all.end(), ending(path)) != all.end();
}

std::vector<MeshNode> read_mesh_nodes(const std::string& path) {
    std::vector<MeshNode> nodes;
    import_meshes(path, [&](const aiScene& scene) {
        visit_nodes(scene, [&](const aiNode& node, const Transform& to_world) {
            MeshNode& made = nodes.emplace_back();
            made.name = node.mName.C_Str();
            Welder welder(made.mesh);
            add_node(scene, node, to_world, welder, made.mesh);
            centre(made);
        });
    });
    return nodes;
}

Mesh read_mesh(const std::string& path) {
    Mesh mesh;
    import_meshes(path, [&](const aiScene& scene) {
        Welder welder(mesh);
        visit_nodes(scene, [&](const aiNode& node, const Transform& to_world) {
            add_node(scene, node, to_world, welder, mesh);
        });
    });
    return mesh;
}

}  // namespace clinch::io
