#include "tools/io/scene_shapes.hpp"

#include <filesystem>
#include <initializer_list>
#include <utility>

#include "tools/io/mesh_file.hpp"
#include "tools/io/text.hpp"

namespace clinch::io {
namespace fs = std::filesystem;
namespace {

/// The bytes of a shape's class and numbers: equal for equal shapes only.
class Key {
public:
    explicit Key(std::string type) : text_(std::move(type)) { text_ += '\0'; }
    Key& operator<<(double number) {
        text_.append(reinterpret_cast<const char*>(&number), sizeof number);
        return *this;
    }
    Key& operator<<(const Vec3& v) { return *this << v.x << v.y << v.z; }
    const std::string& text() const noexcept { return text_; }

private:
    std::string text_;
};

}  // namespace

SceneShapes::SceneShapes(Scene& scene, const JsonValue& document, const std::string& folder) : scene_(scene) {
    if (!document.has("meshes")) return;
    const JsonValue meshes = document.at("meshes");
    if (!meshes.is_object()) meshes.fail("must be an object from names to mesh files");
    for (const auto& item : meshes.json().items()) {
        const JsonValue entry = meshes.at(item.key().c_str());
        const std::string path = (fs::path(folder) / entry.text()).lexically_normal().string();
        if (!is_mesh_path(path))
            entry.fail("is '" + entry.text() + "'; a file with one of the endings " + join(mesh_endings()) +
                       " is accepted");
        std::error_code failure;
        if (!fs::is_regular_file(path, failure))
            entry.fail("is '" + entry.text() + "' and there is no file " + path + "; an existing file is accepted");
        mesh_paths_.emplace(item.key(), path);
    }
}

const SceneShapes::Entry& SceneShapes::share(const std::string& key, Shape shape, std::string why_rejected) {
    const auto found = entries_.find(key);
    if (found != entries_.end()) return found->second;
    return entries_.emplace(key, Entry{scene_.add_shape(std::move(shape)), std::move(why_rejected)}).first->second;
}

const SceneShapes::Entry& SceneShapes::add(const JsonValue& shape) {
    const std::string type = shape.at("type").text();
    Key key(type);
    if (type == "sphere") {
        shape.only_keys({"type", "radius"});
        const Sphere made{shape.at("radius").number()};
        return share((key << made.radius).text(), made);
    }
    if (type == "box") {
        shape.only_keys({"type", "half_extents"});
        const Box made{shape.at("half_extents").vec3()};
        return share((key << made.half_extents).text(), made);
    }
    if (type == "capsule" || type == "cylinder" || type == "cone") {
        shape.only_keys({"type", "radius", "half_height"});
        const double radius = shape.at("radius").number(), half_height = shape.at("half_height").number();
        key << radius << half_height;
        if (type == "capsule") return share(key.text(), Capsule{radius, half_height});
        if (type == "cylinder") return share(key.text(), Cylinder{radius, half_height});
        return share(key.text(), Cone{radius, half_height});
    }
    if (type == "plane") {
        shape.only_keys({"type", "normal", "offset"});
        const Plane made{shape.at("normal").vec3(), shape.at("offset").number()};
        return share((key << made.normal << made.offset).text(), made);
    }
    if (type == "hull") {
        shape.only_keys({"type", "points"});
        const JsonValue points = shape.at("points");
        points.require_array();
        Hull made;
        made.points.reserve(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            made.points.push_back(points.at(i).vec3());
            key << made.points.back();
        }
        return share(key.text(), std::move(made));
    }
    if (type == "mesh") return add_mesh(shape);
    shape.at("type").fail("is '" + type + "'; sphere, box, capsule, cylinder, cone, plane, hull and mesh are accepted");
}

const SceneShapes::Entry& SceneShapes::add_mesh(const JsonValue& shape) {
    shape.only_keys({"type", "mesh", "scale"});
    const std::string name = shape.at("mesh").text();
    const double scale = shape.has("scale") ? shape.at("scale").number() : 1.0;
    const auto path = mesh_paths_.find(name);
    if (path == mesh_paths_.end()) shape.at("mesh").fail("is '" + name + "'; a name that stands in meshes is accepted");

    Key key("mesh");
    key << scale;
    const std::string text = key.text() + path->second;
    const auto known = entries_.find(text);
    if (known != entries_.end()) return known->second;
    auto source = meshes_.find(path->second);
    if (source == meshes_.end()) source = meshes_.emplace(path->second, read_mesh(path->second)).first;
    // A scene knows no scale: a mesh without triangles stands for one of no size.
    if (!(scale > 0.0)) return share(text, Mesh{}, "scale is " + to_text(scale) + " and must be > 0");
    Mesh made = source->second;
    for (Vec3& v : made.vertices) v = {v.x * scale, v.y * scale, v.z * scale};
    return share(text, std::move(made));
}

}  // namespace clinch::io
