#include "tools/io/mesh_import.hpp"

#include <assimp/config.h>
#include <assimp/postprocess.h>

#include <algorithm>
#include <array>
#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <exception>
#include <memory>
#include <new>
#include <string_view>
#include <vector>

#include "tools/io/error.hpp"
#include "tools/io/input_file.hpp"
#include "tools/io/text.hpp"

namespace clinch::io {
namespace {

/// What the importer says when it goes on without a part of the geometry.
constexpr std::array<std::string_view, 5> loss_messages{
    "out-of-range indices",               // glTF: faces
    "vertices were dropped",              // glTF: a count that fits no whole number of faces
    "in the header is incorrect",         // OFF: fewer vertices or faces than promised
    "Ignoring empty face",                // OBJ
    "Unable to parse property instance",  // PLY: an element
};
/// What it says when a polygon that crosses itself was split into too few triangles.
constexpr std::string_view triangulation_message = "Failed to triangulate";

/// Listens to the importer's log while it lives.
class LogWatch {
public:
    LogWatch() {
        auto listener = std::make_unique<Listener>(*this);
        Assimp::DefaultLogger::set(listener.release());  // which owns it
    }                                                    // NOLINT(clang-analyzer-cplusplus.NewDeleteLeaks)
    ~LogWatch() { Assimp::DefaultLogger::set(nullptr); }
    LogWatch(const LogWatch&) = delete;
    LogWatch& operator=(const LogWatch&) = delete;

    /// The first message that tells of lost geometry, or nothing.
    const std::string& loss() const noexcept { return loss_; }
    bool triangulation_failed() const noexcept { return triangulation_failed_; }

private:
    class Listener : public Assimp::Logger {
    public:
        explicit Listener(LogWatch& watch) : watch_(watch) {}
        bool attachStream(Assimp::LogStream*, unsigned) override { return false; }
        bool detachStream(Assimp::LogStream*, unsigned) override { return false; }

    protected:
        void OnDebug(const char*) override {}
        void OnVerboseDebug(const char*) override {}
        void OnInfo(const char*) override {}
        void OnWarn(const char* message) override { watch_.note(message); }
        void OnError(const char* message) override { watch_.note(message); }

    private:
        LogWatch& watch_;
    };

    void note(std::string_view message) {
        const auto says = [&](std::string_view part) { return message.find(part) != std::string_view::npos; };
        if (loss_.empty() && std::any_of(loss_messages.begin(), loss_messages.end(), says)) loss_ = message;
        if (says(triangulation_message)) triangulation_failed_ = true;
    }

    std::string loss_;
    bool triangulation_failed_ = false;
};

/// The importer's later steps trust what is checked here.
void check_mesh(const aiMesh& mesh) {
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        const aiFace& face = mesh.mFaces[f];
        if (face.mNumIndices > 0 && face.mIndices == nullptr) throw InputError("a face has no vertices");
        for (unsigned k = 0; k < face.mNumIndices; ++k)
            if (face.mIndices[k] >= mesh.mNumVertices) throw InputError("a face names a vertex that is not there");
    }
}

void check_scene(const aiScene& scene) {
    for (unsigned i = 0; i < scene.mNumMeshes; ++i) check_mesh(*scene.mMeshes[i]);
    std::vector<const aiNode*> open;
    if (scene.mRootNode != nullptr) open.push_back(scene.mRootNode);
    while (!open.empty()) {
        const aiNode& node = *open.back();
        open.pop_back();
        for (unsigned i = 0; i < node.mNumMeshes; ++i)
            if (node.mMeshes[i] >= scene.mNumMeshes) throw InputError("a node names a mesh that is not there");
        open.insert(open.end(), node.mChildren, node.mChildren + node.mNumChildren);
    }
}

std::string one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
}

/// `triangulate` off: polygons stay as they are in the file. Returns null if a polygon could not be split.
const aiScene* read(Assimp::Importer& importer, const std::string& path, bool triangulate) {
    const LogWatch log;
    importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);  // coordinates as in the file
    importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);           // no meshes made up for bones
    const aiScene* scene = importer.ReadFile(path, 0);
    if (scene == nullptr) throw InputError(one_line(importer.GetErrorString()));
    if (!log.loss().empty()) throw InputError(one_line(log.loss()));
    check_scene(*scene);
    if (!triangulate) return scene;
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate);
    if (scene == nullptr) throw InputError(one_line(importer.GetErrorString()));
    return log.triangulation_failed() ? nullptr : scene;
}

}  // namespace

void import_meshes(const std::string& path, const std::function<void(const aiScene&)>& use) {
    if (InputFile(path).size() == 0) throw InputError(path + ": is empty; a mesh file is accepted");
    try {
        Assimp::Importer importer;
        const aiScene* scene = read(importer, path, true);
        if (scene == nullptr) scene = read(importer, path, false);
        use(*scene);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) {
        throw InputError(path + ": cannot be read as a " + ending(path) + " mesh file: " + e.what());
    }
}

}  // namespace clinch::io
