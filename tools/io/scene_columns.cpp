#include "tools/io/scene_columns.hpp"

#include <filesystem>
#include <utility>

#include "tools/io/error.hpp"
#include "tools/io/npy.hpp"

namespace clinch::io {
namespace {

std::vector<NpyType> float_types() {
    return {NpyType::Float32, NpyType::Float64};
}

}  // namespace

NpyFile BodyColumns::open(const JsonValue& value, const std::vector<NpyType>& types, std::uint64_t width) const {
    const std::string path = (std::filesystem::path(folder_) / value.text()).lexically_normal().string();
    NpyFile file(path, types, width);
    if (file.rows() != count_)
        value.fail("is " + path + ", which has " + std::to_string(file.rows()) + " rows; bodies.count, " +
                   std::to_string(count_) + ", is accepted");
    return file;
}

void BodyColumns::read_motion(const JsonValue& value) {
    NpyFile file = open(value, {NpyType::UInt8}, 0);
    const std::vector<std::uint32_t> numbers = file.read<std::uint32_t>();
    motion_.reserve(numbers.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (numbers[i] > 3)
            throw InputError(file.path() + ": row " + std::to_string(i) + " is " + std::to_string(numbers[i]) +
                             "; 0 (static), 1 (kinematic), 2 (dynamic) and 3 (sleeping) are accepted");
        motion_.push_back(static_cast<Motion>(numbers[i]));
    }
}

void BodyColumns::read(const JsonValue& columns, const JsonValue& bodies) {
    columns.only_keys(
        {"position", "rotation", "velocity", "angular_velocity", "margin", "group", "mask", "motion", "shape"});
    for (const auto& item : columns.json().items())
        if (bodies.has(item.key().c_str()))
            columns.at(item.key().c_str())
                .fail("is a column and one value for all as well; one of the two is accepted");
    const auto floats = [&](const char* key, std::uint64_t width, std::vector<double>& column) {
        if (columns.has(key)) column = open(columns.at(key), float_types(), width).read<double>();
    };
    const auto wholes = [&](const char* key, std::vector<std::uint32_t>& column) {
        if (columns.has(key)) column = open(columns.at(key), {NpyType::UInt32}, 0).read<std::uint32_t>();
    };
    floats("position", 3, position_);
    floats("rotation", 4, rotation_);
    floats("velocity", 3, velocity_);
    floats("angular_velocity", 3, angular_velocity_);
    floats("margin", 0, margin_);
    wholes("group", group_);
    wholes("mask", mask_);
    wholes("shape", shape_);
    if (columns.has("motion")) read_motion(columns.at("motion"));
    if (columns.has("shape")) shape_place_ = columns.at("shape").place();
}

void BodyColumns::fill(LoadedScene& loaded, const Body& common, const std::vector<SceneShapes::Entry>& choices) const {
    for (std::size_t i = 0; i < shape_.size(); ++i)
        if (shape_[i] >= choices.size())
            throw InputError(shape_place_ + ": row " + std::to_string(i) + " is " + std::to_string(shape_[i]) +
                             " and shapes has " + std::to_string(choices.size()) +
                             " entries; a lower number is accepted");
    if (count_ == 0) return;
    Body first = common;
    first.shape = choices.front().id;
    Scene& scene = loaded.scene;
    scene.add_bodies(count_, first);
    if (!position_.empty()) scene.set_positions(position_.data(), count_);
    if (!rotation_.empty()) scene.set_rotations(rotation_.data(), count_);
    if (!velocity_.empty()) scene.set_velocities(velocity_.data(), count_);
    if (!angular_velocity_.empty()) scene.set_angular_velocities(angular_velocity_.data(), count_);
    if (!margin_.empty()) scene.set_margins(margin_.data(), count_);
    if (!motion_.empty()) scene.set_motions(motion_.data(), count_);
    if (!group_.empty() || !mask_.empty()) {
        const std::vector<std::uint32_t> group =
            group_.empty() ? std::vector<std::uint32_t>(count_, common.group) : group_;
        const std::vector<std::uint32_t> mask = mask_.empty() ? std::vector<std::uint32_t>(count_, common.mask) : mask_;
        scene.set_filters(group.data(), mask.data(), count_);
    }
    fill_shapes(loaded, choices);
}

void BodyColumns::fill_shapes(LoadedScene& loaded, const std::vector<SceneShapes::Entry>& choices) const {
    std::vector<std::uint32_t> ids;
    ids.reserve(shape_.size());
    for (const std::uint32_t choice : shape_) ids.push_back(choices[choice].id.index);
    if (!ids.empty()) loaded.scene.set_shapes(ids.data(), ids.size());
    for (std::size_t i = 0; i < count_; ++i) {
        const std::string& why = choices[shape_.empty() ? 0 : shape_[i]].why_rejected;
        if (!why.empty()) loaded.reasons.push_back({static_cast<std::uint32_t>(i), why});
    }
}

}  // namespace clinch::io
