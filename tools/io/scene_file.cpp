#include "tools/io/scene_file.hpp"

#include <utility>

#include "tools/io/error.hpp"
#include "tools/io/mesh_file.hpp"
#include "tools/io/scene_json.hpp"
#include "tools/io/text.hpp"

namespace clinch::io {
namespace {

LoadedScene read_mesh_scene(const std::string& path) {
    LoadedScene loaded;
    for (MeshNode& node : read_mesh_nodes(path)) {
        Body body;
        body.shape = loaded.scene.add_shape(std::move(node.mesh));
        body.pose.position = node.centre;
        loaded.scene.add_body(body);
        loaded.names.push_back(std::move(node.name));
    }
    return loaded;
}

}  // namespace

LoadedScene read_scene(const std::string& path) {
    if (ending(path) == ".json") return read_scene_json(path);
    if (is_mesh_path(path)) return read_mesh_scene(path);
    throw InputError(path + ": has the ending '" + ending(path) + "'; .json, " + join(mesh_endings()) +
                     " are accepted for a scene");
}

std::vector<Rejection> merge_rejections(const std::vector<Rejection>& found, const std::vector<Rejection>& reasons) {
    std::vector<Rejection> merged = found;
    std::size_t next = 0;
    for (Rejection& rejection : merged) {
        while (next < reasons.size() && reasons[next].body < rejection.body) ++next;
        if (next < reasons.size() && reasons[next].body == rejection.body) rejection.why = reasons[next].why;
    }
    return merged;
}

}  // namespace clinch::io
