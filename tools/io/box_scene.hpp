// Boxes out of .npy files as bodies of a scene.
#pragma once

#include <string>

#include "tools/io/scene_file.hpp"

namespace clinch::io {

/// Reads the file as read_boxes does, but makes a body with a Box shape of each row, in float64 whatever the file
/// holds. A middle or half width that float64 does not hold is rounded; a width of 0, which no shape has, becomes 2^-60
/// of the row's largest half width (of a point: of its largest coordinate), at least 2^-100. LoadedScene::slack says
/// how much that is together, and the body's margin is what rounding may have taken away, so that boxes that touch in
/// the file are not lost. Rows that read_boxes rejects are rejected bodies, for the same reason.
LoadedScene read_box_scene(const std::string& path);

}  // namespace clinch::io
