// Mesh files: .glb .gltf .obj .stl .ply .dae .off.
#pragma once

#include <string>
#include <vector>

#include "clinch/pose.hpp"
#include "clinch/shape.hpp"

namespace clinch::io {

/// A node of a mesh file that bears at least one mesh.
struct MeshNode {
    std::string name;  ///< as in the file; may be empty or shared
    Vec3 centre;       ///< middle of its bounds in the file's world space; 0 without triangles
    /// All its triangles in world space, less `centre`. Corners at exactly one place are one vertex;
    /// points and lines are left out, so that there may be no triangle at all.
    Mesh mesh;
};

/// The endings that are read, lower case with their dots.
const std::vector<std::string>& mesh_endings();
/// True when the path's ending, in whatever case, is one of them.
bool is_mesh_path(const std::string& path);

/// Reads every node that bears a mesh, in depth-first order; transforms are put together in float64,
/// faces split into triangles. Coordinates are those of the file, whichever axis it says is up; the
/// unit of a .dae file is applied. A file that is missing, empty or that cannot be read as what its ending
/// says is InputError. One without meshes gives no nodes.
std::vector<MeshNode> read_mesh_nodes(const std::string& path);

/// Reads all nodes as one mesh in the file's world space. Errors as read_mesh_nodes.
Mesh read_mesh(const std::string& path);

}  // namespace clinch::io
