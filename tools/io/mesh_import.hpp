// Assimp behind one call: what it reports by the way becomes an error where geometry was lost.
#pragma once

#include <assimp/scene.h>

#include <functional>
#include <string>

namespace clinch::io {

/// Reads `path` and hands the importer's scene to `use`: each corner of a face is a vertex that is there, each mesh
/// of a node is there, and polygons are split into triangles but for those that cross themselves. A file that is
/// missing, empty, unreadable as what its ending says, or of which the importer had to leave out a part is InputError;
/// nothing is printed. One thread at a time: the importer's log is one for the whole process.
void import_meshes(const std::string& path, const std::function<void(const aiScene&)>& use);

}  // namespace clinch::io
