// Scenes out of scene .json files and mesh files.
#pragma once

#include <string>
#include <vector>

#include "clinch/scene.hpp"

namespace clinch::io {

struct LoadedScene {
    Scene scene;                     ///< body i of the file is row i
    std::vector<std::string> names;  ///< one a row, empty where the file gives none
    /// Bodies the scene rejects for a cause that only the file shows (a mesh's scale <= 0), ascending: this
    /// reason is the better one.
    std::vector<Rejection> reasons;
    /// How far each body's shape may lie from the one in the file, one a row; empty where all are the file's.
    std::vector<double> slack;
};

/// Reads a scene .json file or a mesh file, by its ending; another ending is InputError, as is every
/// structural fault. Values that make one body meaningless are left to Scene::rejected().
/// Equal shapes are one shape of the scene; of a mesh file each node that bears a mesh is a body, placed
/// at the middle of its bounds.
LoadedScene read_scene(const std::string& path);

/// All bodies a step of this scene leaves out, ascending, with the best reason known: those of `found`
/// (by the scene or a step, ascending) in the words of `reasons` where it has some.
std::vector<Rejection> merge_rejections(const std::vector<Rejection>& found, const std::vector<Rejection>& reasons);

}  // namespace clinch::io
