// clinch pairs: the broad phase.
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <variant>
#include <vector>

#include "clinch/context.hpp"
#include "clinch/pipeline.hpp"
#include "tools/io/boxes.hpp"
#include "tools/io/error.hpp"
#include "tools/io/output_file.hpp"
#include "tools/io/pairs.hpp"
#include "tools/io/scene_file.hpp"
#include "tools/io/text.hpp"
#include "tools/program/command.hpp"
#include "tools/program/measure.hpp"
#include "tools/program/options.hpp"
#include "tools/program/progress.hpp"
#include "tools/program/stats.hpp"

namespace clinch::program {
namespace {

struct Texts {
    std::string input, output;
    StepTexts step;
};

using Input = std::variant<io::BoxFile, io::LoadedScene>;

Input read_input(const std::string& path) {
    if (io::ending(path) == ".npy") return io::read_boxes(path);
    return io::read_scene(path);
}

std::vector<Rejection> rejected_before(const Input& input) {
    if (const auto* const boxes = std::get_if<io::BoxFile>(&input)) return boxes->rejected;
    const auto& loaded = std::get<io::LoadedScene>(input);
    return io::merge_rejections(loaded.scene.rejected(), loaded.reasons);
}

std::string body_text(const Input& input, std::uint32_t body) {
    const auto* const loaded = std::get_if<io::LoadedScene>(&input);
    if (loaded == nullptr || loaded->names[body].empty()) return "body " + std::to_string(body);
    return "body " + std::to_string(body) + " ('" + loaded->names[body] + "')";
}

/// Warns of the first few bodies that are left out; under --strict the first one is an error.
void tell_rejected(const std::string& path, const Input& input, const std::vector<Rejection>& rejected, bool strict) {
    constexpr std::size_t told = 5;
    const auto sentence = [&](const Rejection& r) {
        return path + ": " + body_text(input, r.body) + " is rejected: " + r.why;
    };
    if (strict && !rejected.empty()) throw io::InputError(sentence(rejected.front()));
    for (std::size_t i = 0; i < rejected.size() && i < told; ++i)
        std::cerr << "clinch: warning: " << sentence(rejected[i]) << '\n';
    if (rejected.size() > told)
        std::cerr << "clinch: warning: " << path << ": " << rejected.size() - told << " more bodies are rejected\n";
}

bool same_file(const std::string& a, const std::string& b) {
    std::error_code failure;
    return a == b || std::filesystem::equivalent(a, b, failure);
}

/// A result must not replace what it is made from, nor another result.
void check_targets(const Texts& texts) {
    const std::string& stats = texts.step.stats;
    if (same_file(texts.input, texts.output))
        throw io::InputError("-o is the input, " + texts.input + "; another file is accepted");
    if (stats.empty()) return;
    if (same_file(texts.input, stats))
        throw io::InputError("--stats is the input, " + stats + "; another file is accepted");
    if (same_file(texts.output, stats))
        throw io::InputError("--stats is the target of -o, " + stats + "; another file is accepted");
}

Context make_context(const StepOptions& options) {
    if (options.host_only) return Context::host_only();
    ContextOptions context;
    context.devices = options.devices;
    context.log = [](const std::string& line) { std::cerr << "clinch: note: " << line << '\n'; };
    return Context(context);
}

/// The step over boxes or over a scene. Owns what the pairs it returns live in.
class Stepper {
public:
    Stepper(Context& context, const BroadPhaseOptions& options, const Input& input) : input_(input) {
        if (std::holds_alternative<io::BoxFile>(input))
            broad_phase_.emplace(context, options);
        else
            pipeline_.emplace(context, PipelineOptions{options});
    }

    StepOutcome operator()(std::uint64_t run) {
        if (broad_phase_) {
            const View<const Pair> pairs = broad_phase_->find(std::get<io::BoxFile>(input_).boxes);
            return {pairs, broad_phase_->report()};
        }
        const Scene& scene = std::get<io::LoadedScene>(input_).scene;
        if (run == 0) return outcome(pipeline_->step(scene));
        // A scene that has not changed would cost next to nothing: a copy counts as a new one, so that
        // every body is sent and computed again.
        const Scene copy = scene;
        copy.rejected();
        return outcome(pipeline_->step(copy));
    }

private:
    static StepOutcome outcome(const StepResult& result) { return {result.pairs(), result.report()}; }

    const Input& input_;
    std::optional<BroadPhase> broad_phase_;
    std::optional<Pipeline> pipeline_;
};

void write_results(const Texts& texts, io::PairFormat format, View<const Pair> pairs, const std::string& stats) {
    io::OutputFile output(texts.output);
    io::write_pairs(output, format, pairs);
    output.finish();
    if (texts.step.stats.empty()) {
        output.commit();
        return;
    }
    // Both are complete before either takes its name.
    io::OutputFile stats_file(texts.step.stats);
    stats_file.write(stats);
    stats_file.finish();
    output.commit();
    stats_file.commit();
}

int run(const Texts& texts) {
    const io::PairFormat format = io::pair_format(texts.output);
    const StepOptions options = check_step_options(texts.step);
    check_targets(texts);

    const auto start = std::chrono::steady_clock::now();
    const Input input = read_input(texts.input);
    StatsInput known;
    known.read_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    const std::vector<Rejection> before = rejected_before(input);
    if (options.strict) tell_rejected(texts.input, input, before, true);
    io::check_writable(texts.output);
    if (!options.stats.empty()) io::check_writable(options.stats);

    Context context = make_context(options);
    // Without --stats nobody reads the time of a second run.
    const std::uint64_t timed = options.stats.empty() && options.repeat == 1 ? 0 : options.repeat;
    ProgressBar bar("pairs");
    double runs_done = 0.0;
    BroadPhaseOptions broad;
    broad.algorithm = options.algorithm;
    broad.order = options.order;
    broad.measure_stages = !options.stats.empty();
    broad.progress = [&](double share) { bar.show((runs_done + share) / static_cast<double>(timed + 1)); };
    Stepper step(context, broad, input);
    const Measured measured = measure(timed, [&](std::uint64_t number) {
        runs_done = static_cast<double>(number);
        return step(number);
    });

    known.rejected = io::merge_rejections(measured.last.report.rejected, before);
    tell_rejected(texts.input, input, known.rejected, options.strict);
    write_results(texts, format, measured.last.pairs,
                  options.stats.empty() ? "" : stats_text(measured, context, known));
    return 0;
}

}  // namespace

Command add_pairs_command(CLI::App& app) {
    auto texts = std::make_shared<Texts>();
    CLI::App* const command = app.add_subcommand("pairs", "Broad phase: all overlapping pairs of bounding boxes");
    command
        ->add_option("INPUT", texts->input,
                     "Boxes (.npy), a scene (.json) or a mesh file (.glb .gltf .obj .stl .ply .dae .off)")
        ->type_name("")
        ->required();
    command->add_option("-o,--output", texts->output, "File to write: .npy, .csv, or - for CSV on standard output")
        ->type_name("FILE")
        ->required();
    add_step_options(*command, texts->step);
    return {command, [texts] { return run(*texts); }};
}

}  // namespace clinch::program
