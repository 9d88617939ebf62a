// clinch contacts: broad and narrow phase.
#include "tools/io/contacts.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "clinch/pipeline.hpp"
#include "tools/io/box_scene.hpp"
#include "tools/io/text.hpp"
#include "tools/program/command.hpp"
#include "tools/program/step_job.hpp"

namespace clinch::program {
namespace {

StepInput read_input(const std::string& path) {
    if (io::ending(path) == ".npy") return io::read_box_scene(path);
    return io::read_scene(path);
}

/// Contacts of scenes whose shapes may lie a little off those of the file: the errors grow by that.
class ContactStep {
public:
    ContactStep(Context& context, const BroadPhaseOptions& broad, const StepOptions& step, const io::LoadedScene& input)
        : input_(input), tolerance_(step.narrow.tolerance), pipeline_(context, options_of(broad, step)) {}

    StepOutcome operator()(const Scene& scene) {
        const StepResult& result = pipeline_.step(scene);
        StepOutcome outcome{result.pairs(), result.report(), result.contacts(), result.narrow_report()};
        if (!input_.slack.empty()) grow_errors(outcome);
        return outcome;
    }

private:
    static PipelineOptions options_of(const BroadPhaseOptions& broad, const StepOptions& step) {
        PipelineOptions options;
        options.broad_phase = broad;
        options.contacts = true;
        options.narrow_phase = step.narrow;
        return options;
    }
    double slack(std::uint32_t body) const { return body < input_.slack.size() ? input_.slack[body] : 0.0; }

    void grow_errors(StepOutcome& outcome) {
        grown_.assign(outcome.contacts.begin(), outcome.contacts.end());
        for (Contact& contact : grown_) {
            const double off = slack(contact.a) + slack(contact.b);
            if (off > 0.0) contact.error = (contact.error + off) * (1.0 + 0x1p-50);
        }
        outcome.contacts = grown_;
        if (!tolerance_) return;
        outcome.report.tolerance_missed = static_cast<std::uint64_t>(std::count_if(
            grown_.begin(), grown_.end(), [this](const Contact& contact) { return contact.error > *tolerance_; }));
        outcome.narrow->tolerance_missed = outcome.report.tolerance_missed;
    }

    const io::LoadedScene& input_;
    std::optional<double> tolerance_;
    Pipeline pipeline_;
    std::vector<Contact> grown_;
};

Step prepare(Context& context, const BroadPhaseOptions& broad, const StepOptions& options, const StepInput& input) {
    const auto& loaded = std::get<io::LoadedScene>(input);
    const auto step = std::make_shared<ContactStep>(context, broad, options, loaded);
    return [step, &loaded](std::uint64_t run) {
        return step_anew(loaded.scene, run, [&](const Scene& scene) { return (*step)(scene); });
    };
}

void write(io::OutputFile& file, io::TableFormat format, const StepOutcome& outcome) {
    io::write_contacts(file, format, outcome.contacts);
}

}  // namespace

Command add_contacts_command(CLI::App& app) {
    auto texts = std::make_shared<StepJobTexts>();
    CLI::App* const command =
        app.add_subcommand("contacts", "Broad and narrow phase: where and how deeply shapes touch");
    add_step_job_options(*command, *texts, true);
    return {command, [texts] { return run_step_job(*texts, {"contacts", true, read_input, prepare, write}); }};
}

}  // namespace clinch::program
