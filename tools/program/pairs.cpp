// clinch pairs: the broad phase.
#include <memory>
#include <string>

#include "clinch/pipeline.hpp"
#include "tools/io/pairs.hpp"
#include "tools/io/text.hpp"
#include "tools/program/command.hpp"
#include "tools/program/step_job.hpp"

namespace clinch::program {
namespace {

StepInput read_input(const std::string& path) {
    if (io::ending(path) == ".npy") return io::read_boxes(path);
    return io::read_scene(path);
}

Step prepare(Context& context, const BroadPhaseOptions& broad, const StepOptions&, const StepInput& input) {
    if (const auto* const file = std::get_if<io::BoxFile>(&input)) {
        const auto broad_phase = std::make_shared<BroadPhase>(context, broad);
        return [broad_phase, file](std::uint64_t) {
            const View<const Pair> pairs = broad_phase->find(file->boxes);
            return StepOutcome{pairs, broad_phase->report()};
        };
    }
    PipelineOptions options;
    options.broad_phase = broad;
    const auto pipeline = std::make_shared<Pipeline>(context, options);
    const Scene& scene = std::get<io::LoadedScene>(input).scene;
    return [pipeline, &scene](std::uint64_t run) {
        return step_anew(scene, run, [&](const Scene& stepped) {
            const StepResult& result = pipeline->step(stepped);
            return StepOutcome{result.pairs(), result.report()};
        });
    };
}

void write(io::OutputFile& file, io::TableFormat format, const StepOutcome& outcome) {
    io::write_pairs(file, format, outcome.pairs);
}

}  // namespace

Command add_pairs_command(CLI::App& app) {
    auto texts = std::make_shared<StepJobTexts>();
    CLI::App* const command = app.add_subcommand("pairs", "Broad phase: all overlapping pairs of bounding boxes");
    add_step_job_options(*command, *texts, false);
    return {command, [texts] { return run_step_job(*texts, {"pairs", false, read_input, prepare, write}); }};
}

}  // namespace clinch::program
