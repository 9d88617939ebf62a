// The shapes of a scene .json file.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "clinch/scene.hpp"
#include "tools/io/json_value.hpp"

namespace clinch::io {

/// Puts the shapes that a file describes into a scene, equal ones once, and reads its mesh files, each
/// once and when it is first used. Every fault of the file is InputError.
class SceneShapes {
public:
    /// Reads the entries of "meshes" in `document`, an object from name to path, if it has any; paths are relative to
    /// `folder`. A file that is not there or has an ending that is not read is a fault even if unused.
    SceneShapes(Scene& scene, const JsonValue& document, const std::string& folder);

    /// A shape of the scene, and why it bears no body if only the file shows that.
    struct Entry {
        ShapeId id;
        std::string why_rejected;
    };
    const Entry& add(const JsonValue& shape);

private:
    const Entry& share(const std::string& key, Shape shape, std::string why_rejected = {});
    const Entry& add_mesh(const JsonValue& shape);

    Scene& scene_;
    std::unordered_map<std::string, std::string> mesh_paths_;  // by name
    std::unordered_map<std::string, Mesh> meshes_;             // by path, unscaled
    std::unordered_map<std::string, Entry> entries_;           // by class and numbers
};

}  // namespace clinch::io
