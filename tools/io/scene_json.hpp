// Scene .json files.
#pragma once

#include <string>

#include "tools/io/scene_file.hpp"

namespace clinch::io {

/// Reads a scene .json file: "bodies" as a list, or as one object with a count, values for all bodies, and
/// "columns" of .npy files ("columns" and "shapes" stand in that object or beside it).
LoadedScene read_scene_json(const std::string& path);

}  // namespace clinch::io
