// The bodies of a mesh file as triangles ready to be drawn.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/pose.hpp"
#include "tools/io/mesh_file.hpp"

namespace clinch::draw {

/// A corner of a triangle, world frame, with the unit normal of the smooth surface there.
struct Corner {
    Vec3 position;
    Vec3 normal;
};
using Triangle = std::array<Corner, 3>;

struct Part {
    std::vector<Triangle> triangles;
    Vec3 min, max;  ///< its bounding box
};

/// One part for each node of a mesh file, in their order: the order of the bodies the program makes.
std::vector<Part> make_parts(const std::vector<io::MeshNode>& nodes);

/// Reads the CSV file of pairs that the clinch program writes. Anything else, or an index that is
/// not below `count`, is io::InputError.
std::vector<Pair> read_pairs(const std::string& path, std::size_t count);

/// The bodies paired with `body`, in the order of `pairs`.
std::vector<std::uint32_t> partners(const std::vector<Pair>& pairs, std::uint32_t body);

}  // namespace clinch::draw
