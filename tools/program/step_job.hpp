// What all commands that step an input have in common: reading it, telling what is rejected, timing the step, writing
// the result and the statistics.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <string>
#include <variant>

#include "clinch/context.hpp"
#include "tools/io/boxes.hpp"
#include "tools/io/output_file.hpp"
#include "tools/io/scene_file.hpp"
#include "tools/io/table_format.hpp"
#include "tools/program/measure.hpp"
#include "tools/program/options.hpp"

namespace clinch::program {

/// As typed.
struct StepJobTexts {
    std::string input, output;
    StepTexts step;
};

using StepInput = std::variant<io::BoxFile, io::LoadedScene>;
using Step = std::function<StepOutcome(std::uint64_t run)>;

/// What one command does in its own way.
struct StepJob {
    const char* progress;  ///< the name of the progress bar
    bool narrow;           ///< there is a narrow phase
    StepInput (*read)(const std::string& path);
    /// Makes the step over `input`, which it may refer to, as it may to `context`.
    Step (*prepare)(Context& context, const BroadPhaseOptions& broad, const StepOptions& options,
                    const StepInput& input);
    void (*write)(io::OutputFile& file, io::TableFormat format, const StepOutcome& outcome);
};

/// Adds INPUT, -o and the options of a step, with a narrow phase if `narrow`; `texts` must outlive the parsing.
void add_step_job_options(CLI::App& command, StepJobTexts& texts, bool narrow);

/// Does the job and returns the exit status. Failures leave it as exceptions; then no target has changed.
int run_step_job(const StepJobTexts& texts, const StepJob& job);

/// Step number `run` of the scene by `step`. A scene that has not changed would cost next to nothing: each run after
/// the first steps a copy, which counts as a new scene, so that every body is sent and computed again.
StepOutcome step_anew(const Scene& scene, std::uint64_t run, const std::function<StepOutcome(const Scene&)>& step);

}  // namespace clinch::program
