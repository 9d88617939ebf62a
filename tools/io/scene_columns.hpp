// The columns of a scene .json file: one .npy file a field, one row a body.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "clinch/scene.hpp"
#include "tools/io/json_value.hpp"
#include "tools/io/npy.hpp"
#include "tools/io/scene_file.hpp"
#include "tools/io/scene_shapes.hpp"

namespace clinch::io {

/// The columns of `count` bodies; those the file does not give are empty.
class BodyColumns {
public:
    /// `folder`: what paths are relative to.
    BodyColumns(std::size_t count, std::string folder) : count_(count), folder_(std::move(folder)) {}

    /// Reads the files that `columns`, an object from field to path, names. InputError: an unknown field,
    /// one that `bodies` gives as well, a file with faults or of another length than count, a motion that is
    /// none.
    void read(const JsonValue& columns, const JsonValue& bodies);
    /// True when there is a column of shapes, be it of no rows.
    bool chooses_shape() const noexcept { return !shape_place_.empty(); }

    /// Adds the bodies to a scene without any: `common` with the values of the columns over it. `choices` are
    /// what the column of shapes points into, or the one shape of all. An index past them is InputError.
    void fill(LoadedScene& loaded, const Body& common, const std::vector<SceneShapes::Entry>& choices) const;

private:
    NpyFile open(const JsonValue& path, const std::vector<NpyType>& types, std::uint64_t width) const;
    void read_motion(const JsonValue& path);
    void fill_shapes(LoadedScene& loaded, const std::vector<SceneShapes::Entry>& choices) const;

    std::size_t count_;
    std::string folder_;
    std::string shape_place_;  // of the column of shapes in the file; empty: none
    std::vector<double> position_, rotation_, velocity_, angular_velocity_, margin_;
    std::vector<std::uint32_t> group_, mask_, shape_;
    std::vector<Motion> motion_;
};

}  // namespace clinch::io
