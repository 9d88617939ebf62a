#include "tools/program/step_job.hpp"

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <iostream>
#include <system_error>
#include <vector>

#include "clinch/error.hpp"
#include "tools/io/error.hpp"
#include "tools/program/progress.hpp"
#include "tools/program/stats.hpp"

namespace clinch::program {
namespace {

std::vector<Rejection> rejected_before(const StepInput& input) {
    if (const auto* const boxes = std::get_if<io::BoxFile>(&input)) return boxes->rejected;
    const auto& loaded = std::get<io::LoadedScene>(input);
    return io::merge_rejections(loaded.scene.rejected(), loaded.reasons);
}

std::string body_text(const StepInput& input, std::uint32_t body) {
    const auto* const loaded = std::get_if<io::LoadedScene>(&input);
    if (loaded == nullptr || loaded->names[body].empty()) return "body " + std::to_string(body);
    return "body " + std::to_string(body) + " ('" + loaded->names[body] + "')";
}

/// Warns of the first few bodies that are left out; under --strict the first one is an error.
void tell_rejected(const std::string& path, const StepInput& input, const std::vector<Rejection>& rejected,
                   bool strict) {
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
void check_targets(const StepJobTexts& texts) {
    const std::string& stats = texts.step.stats;
    if (same_file(texts.input, texts.output))
        throw io::InputError("-o is the input, " + texts.input + "; another file is accepted");
    if (stats.empty()) return;
    if (same_file(texts.input, stats))
        throw io::InputError("--stats is the input, " + stats + "; another file is accepted");
    if (same_file(texts.output, stats))
        throw io::InputError("--stats is the target of -o, " + stats + "; another file is accepted");
}

/// A narrow phase runs on a device wherever there is one, whichever algorithm finds the pairs, so that its answers
/// do not depend on that.
Context make_context(const StepOptions& options, bool narrow) {
    if (options.host_only && (!narrow || list_devices().empty())) return Context::host_only();
    ContextOptions context;
    context.devices = options.devices;
    context.log = [](const std::string& line) { std::cerr << "clinch: note: " << line << '\n'; };
    return Context(context);
}

void write_results(const StepJobTexts& texts, const StepJob& job, io::TableFormat format, const StepOutcome& outcome,
                   const std::string& stats) {
    io::OutputFile output(texts.output);
    job.write(output, format, outcome);
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

/// What the library refuses at this point is in the input.
template <class Work>
auto of_input(const std::string& path, const Work& work) {
    try {
        return work();
    } catch (const Error& e) {
        if (e.code() != ErrorCode::InvalidArgument) throw;
        throw io::InputError(path + ": " + e.what());
    }
}

Scene copy_of(const Scene& scene) {
    return scene;
}

}  // namespace

void add_step_job_options(CLI::App& command, StepJobTexts& texts, bool narrow) {
    command
        .add_option("INPUT", texts.input,
                    "Boxes (.npy), a scene (.json) or a mesh file (.glb .gltf .obj .stl .ply .dae .off)")
        ->type_name("")
        ->required();
    command.add_option("-o,--output", texts.output, "File to write: .npy, .csv, or - for CSV on standard output")
        ->type_name("FILE")
        ->required();
    add_step_options(command, texts.step, narrow);
}

int run_step_job(const StepJobTexts& texts, const StepJob& job) {
    const io::TableFormat format = io::table_format(texts.output);
    const StepOptions options = check_step_options(texts.step, job.narrow);
    check_targets(texts);

    const auto start = std::chrono::steady_clock::now();
    const StepInput input = job.read(texts.input);
    StatsInput known;
    known.read_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    const std::vector<Rejection> before = rejected_before(input);
    if (options.strict) tell_rejected(texts.input, input, before, true);
    io::check_writable(texts.output);
    if (!options.stats.empty()) io::check_writable(options.stats);

    Context context = make_context(options, job.narrow);
    // Without --stats nobody reads the time of a second run.
    const std::uint64_t timed = options.stats.empty() && options.repeat == 1 ? 0 : options.repeat;
    ProgressBar bar(job.progress);
    double runs_done = 0.0;
    BroadPhaseOptions broad;
    broad.algorithm = options.algorithm;
    broad.order = options.order;
    broad.measure_stages = !options.stats.empty();
    broad.progress = [&](double share) { bar.show((runs_done + share) / static_cast<double>(timed + 1)); };
    const Step step = job.prepare(context, broad, options, input);
    const Measured measured = measure(timed, [&](std::uint64_t number) {
        runs_done = static_cast<double>(number);
        return of_input(texts.input, [&] { return step(number); });
    });

    known.rejected = io::merge_rejections(measured.last.report.rejected, before);
    tell_rejected(texts.input, input, known.rejected, options.strict);
    write_results(texts, job, format, measured.last, options.stats.empty() ? "" : stats_text(measured, context, known));
    return 0;
}

StepOutcome step_anew(const Scene& scene, std::uint64_t run, const std::function<StepOutcome(const Scene&)>& step) {
    if (run == 0) return step(scene);
    const Scene copy = copy_of(scene);
    copy.rejected();
    return step(copy);
}

}  // namespace clinch::program
