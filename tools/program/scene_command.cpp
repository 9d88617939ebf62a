// clinch scene: writes a generated scene.
#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "bench/scenes/bodies.hpp"
#include "bench/scenes/boxes.hpp"
#include "tools/io/error.hpp"
#include "tools/io/npy.hpp"
#include "tools/io/output_file.hpp"
#include "tools/io/scene_writer.hpp"
#include "tools/io/text.hpp"
#include "tools/program/command.hpp"
#include "tools/program/progress.hpp"

namespace clinch::program {
namespace {

struct Texts {
    std::string kind, count, seed = "0", output;
};

template <class Kind>
bool is_one_of(const std::string& name, const std::vector<Kind>& kinds) {
    return std::any_of(kinds.begin(), kinds.end(), [&](const Kind& kind) { return name == kind.name; });
}

void check_ending(const Texts& texts, const char* accepted) {
    if (io::ending(texts.output) != accepted)
        throw io::InputError("-o is '" + texts.output + "'; the ending " + accepted + " is accepted for the kind " +
                             texts.kind);
}

/// Writes box after box, so that memory does not limit the count.
void write_boxes(const Texts& texts, std::uint64_t count, std::uint64_t seed) {
    constexpr std::size_t block = 4096;
    scenes::BoxGenerator generator(texts.kind, count, seed);
    io::OutputFile file(texts.output);
    file.write(io::npy_header("<f4", {count, 6}));
    ProgressBar bar("boxes");
    std::vector<Aabb> boxes;
    for (std::uint64_t made = 0; made < count; made += boxes.size()) {
        boxes.resize(static_cast<std::size_t>(std::min<std::uint64_t>(block, count - made)));
        for (Aabb& box : boxes) box = generator.next();
        file.write(boxes.data(), boxes.size() * sizeof(Aabb));
        bar.show(static_cast<double>(made) / static_cast<double>(count));
    }
    file.commit();
}

void write_bodies(const Texts& texts, std::uint64_t count, std::uint64_t seed) {
    io::check_writable(texts.output);
    const Scene scene = scenes::make_bodies(texts.kind, static_cast<std::size_t>(count), seed);
    io::OutputFile file(texts.output);
    io::write_scene(file, scene);
    file.commit();
}

[[noreturn]] void throw_no_kind(const std::string& name) {
    std::vector<std::string> known;
    for (const scenes::BoxKind& kind : scenes::box_kinds()) known.emplace_back(kind.name);
    for (const scenes::BodyKind& kind : scenes::body_kinds()) known.emplace_back(kind.name);
    throw io::InputError("'" + name + "' is no kind of scene; " + io::join(known) + " are accepted");
}

int run(const Texts& texts) {
    const std::uint64_t count = io::parse_whole(texts.count, "--count", 0, io::max_bodies);
    const std::uint64_t seed = io::parse_whole(texts.seed, "--seed", 0, std::numeric_limits<std::uint64_t>::max());
    if (is_one_of(texts.kind, scenes::box_kinds())) {
        check_ending(texts, ".npy");
        write_boxes(texts, count, seed);
    } else if (is_one_of(texts.kind, scenes::body_kinds())) {
        check_ending(texts, ".json");
        write_bodies(texts, count, seed);
    } else {
        throw_no_kind(texts.kind);
    }
    return 0;
}

}  // namespace

Command add_scene_command(CLI::App& app) {
    auto texts = std::make_shared<Texts>();
    CLI::App* const command = app.add_subcommand("scene", "Write a generated scene, the same on every machine");
    std::string kinds = "Kinds of boxes (.npy):";
    for (const scenes::BoxKind& kind : scenes::box_kinds()) kinds += std::string("\n  ") + kind.name + ": " + kind.what;
    kinds += "\nKinds of bodies with shapes (.json):";
    for (const scenes::BodyKind& kind : scenes::body_kinds())
        kinds += std::string("\n  ") + kind.name + ": " + kind.what;
    command->footer(kinds);
    command->add_option("KIND", texts->kind, "What to make: see below")->type_name("")->required();
    command->add_option("--count", texts->count, "Number of bodies, 0 to " + std::to_string(io::max_bodies))
        ->type_name("N")
        ->required();
    command->add_option("--seed", texts->seed, "Seed of everything random")->type_name("S")->capture_default_str();
    command->add_option("-o,--output", texts->output, "File to write: .npy or .json, as the kind wants")
        ->type_name("FILE")
        ->required();
    return {command, [texts] { return run(*texts); }};
}

}  // namespace clinch::program
