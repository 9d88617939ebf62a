#include "tools/io/scene_json.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <utility>

#include "tools/io/json_value.hpp"
#include "tools/io/npy.hpp"
#include "tools/io/scene_columns.hpp"
#include "tools/io/scene_shapes.hpp"

namespace clinch::io {
namespace {

constexpr std::array<const char*, 4> motion_names{"static", "kinematic", "dynamic", "sleeping"};

Motion motion(const JsonValue& value) {
    const std::string name = value.text();
    for (std::size_t i = 0; i < motion_names.size(); ++i)
        if (name == motion_names[i]) return static_cast<Motion>(i);
    value.fail("is '" + name + "'; static, kinematic, dynamic and sleeping are accepted");
}

/// The fields that a body has in both forms but for its shape and name; those left out keep their defaults.
Body body_fields(const JsonValue& value) {
    constexpr std::uint64_t all = 0xffffffffu;
    Body body;
    if (value.has("position")) body.pose.position = value.at("position").vec3();
    if (value.has("rotation")) body.pose.rotation = value.at("rotation").quat();
    if (value.has("velocity")) body.velocity = value.at("velocity").vec3();
    if (value.has("angular_velocity")) body.angular_velocity = value.at("angular_velocity").vec3();
    if (value.has("motion")) body.motion = motion(value.at("motion"));
    if (value.has("group")) body.group = static_cast<std::uint32_t>(value.at("group").whole(all));
    if (value.has("mask")) body.mask = static_cast<std::uint32_t>(value.at("mask").whole(all));
    if (value.has("margin")) body.margin = value.at("margin").number();
    return body;
}

void read_list(const JsonValue& bodies, SceneShapes& shapes, LoadedScene& loaded) {
    loaded.names.reserve(bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const JsonValue value = bodies.at(i);
        value.only_keys({"name", "shape", "position", "rotation", "velocity", "angular_velocity", "motion", "group",
                         "mask", "margin"});
        Body body = body_fields(value);
        const SceneShapes::Entry& shape = shapes.add(value.at("shape"));
        body.shape = shape.id;
        const std::uint32_t index = loaded.scene.add_body(body).index;
        loaded.names.push_back(value.has("name") ? value.at("name").text() : std::string());
        if (!shape.why_rejected.empty()) loaded.reasons.push_back({index, shape.why_rejected});
    }
}

/// An object of "bodies" or, which means the same, of the document around it.
const JsonValue* holder(const char* key, const JsonValue& document, const JsonValue& bodies) {
    if (document.has(key) && bodies.has(key))
        document.at(key).fail("stands in bodies as well; one of the two is accepted");
    return document.has(key) ? &document : bodies.has(key) ? &bodies : nullptr;
}

void read_object(const JsonValue& document, const JsonValue& bodies, const std::string& folder, SceneShapes& shapes,
                 LoadedScene& loaded) {
    bodies.only_keys({"count", "name", "shape", "position", "rotation", "velocity", "angular_velocity", "motion",
                      "group", "mask", "margin", "columns", "shapes"});
    const std::size_t count = bodies.at("count").whole(max_bodies);
    const Body common = body_fields(bodies);
    BodyColumns columns(count, folder);
    if (const JsonValue* const where = holder("columns", document, bodies)) columns.read(where->at("columns"), bodies);

    std::vector<SceneShapes::Entry> choices;
    const JsonValue* const list_holder = holder("shapes", document, bodies);
    if (list_holder != nullptr) {
        const JsonValue list = list_holder->at("shapes");
        list.require_array();
        if (!columns.chooses_shape()) list.fail("is given without a column shape that chooses among them");
        for (std::size_t i = 0; i < list.size(); ++i) choices.push_back(shapes.add(list.at(i)));
    } else if (count > 0 || bodies.has("shape")) {
        choices.push_back(shapes.add(bodies.at("shape")));
    }
    columns.fill(loaded, common, choices);
    loaded.names.assign(count, bodies.has("name") ? bodies.at("name").text() : std::string());
}

}  // namespace

LoadedScene read_scene_json(const std::string& path) {
    const nlohmann::json json = read_json(path);
    const JsonValue document(json, path);
    document.only_keys({"meshes", "bodies", "columns", "shapes"});
    const std::string folder = std::filesystem::path(path).parent_path().string();
    const JsonValue bodies = document.at("bodies");
    LoadedScene loaded;
    SceneShapes shapes(loaded.scene, document, folder);
    if (bodies.is_array()) {
        for (const char* const key : {"columns", "shapes"})
            if (document.has(key))
                document.at(key).fail("goes with bodies as an object with a count; bodies is a list");
        read_list(bodies, shapes, loaded);
    } else if (bodies.is_object()) {
        read_object(document, bodies, folder, shapes, loaded);
    } else {
        bodies.fail("is neither a list of bodies nor an object with a count");
    }
    return loaded;
}

}  // namespace clinch::io
