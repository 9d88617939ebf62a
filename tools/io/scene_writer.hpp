// Scenes into scene .json files.
#pragma once

#include "clinch/scene.hpp"
#include "tools/io/output_file.hpp"

namespace clinch::io {

/// Writes the bodies of a scene as the scene .json that read_scene reads, a line each, in numbers that read back to the
/// same bits; what has its default value is left out. A removed row, a mesh (which a scene file holds in a file of its
/// own) or a number that is not finite is Error InvalidArgument, which names the body.
void write_scene(OutputFile& file, const Scene& scene);

}  // namespace clinch::io
