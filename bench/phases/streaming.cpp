#include "bench/phases/streaming.hpp"

#include <cstring>
#include <stdexcept>
#include <utility>

#include "bench/cpu_parts.hpp"
#include "bench/scenes/falling.hpp"
#include "clinch/pipeline.hpp"
#include "src/device/stopwatch.hpp"
#include "src/pipeline/pipeline_impl.hpp"

namespace clinch::phases {
namespace {

constexpr std::size_t ways = way_names.size();

// A step in which all pairs are found anew, as steps that stream do: nothing is left out because few bodies moved.
const StepResult& step_anew(Pipeline& pipeline, const Scene& scene) {
    pipeline.impl().broad.impl().steps_refused = scene.row_count();
    return pipeline.step(scene);
}

Pipeline make(Context& context, const Play& play, Way way) {
    PipelineOptions options;
    options.contacts = true;
    options.narrow_phase.contacts_per_pair = play.contacts_per_pair;
    options.streaming = way == Way::PhaseEach || way == Way::Streamed;
    Pipeline pipeline(context, options);
    if (way == Way::PhaseEach) pipeline.impl().phases->forced.no_help = true;
    return pipeline;
}

// One pipeline of each way.
class Pipelines {
public:
    Pipelines(Context& one, Context& two, const Play& play) {
        pipelines_.reserve(ways);
        for (std::size_t i = 0; i < ways; ++i) {
            const auto way = static_cast<Way>(i);
            pipelines_.push_back(make(way == Way::Sequence ? one : two, play, way));
        }
    }

    // Steps all, beginning with another one each time, so that none always follows the same.
    Frame step(const Scene& scene, std::size_t frame) {
        Frame stepped{frame, 0, 0, {}, 0.0, 0.0, 0};
        for (std::size_t i = 0; i < ways; ++i) {
            const std::size_t way = (first_ + i) % ways;
            const detail::Stopwatch watch;
            step_anew(pipelines_[way], scene);
            stepped.ms[way] = watch.ms();
        }
        first_ = (first_ + 1) % ways;
        for (std::size_t way = 1; way < ways; ++way) check_same(way, frame);
        const Report& sequence = pipelines_[0].impl().report;
        stepped.pairs = sequence.pairs;
        stepped.contacts = sequence.contacts;
        stepped.broad_ms = sequence.ms.broad;
        stepped.narrow_ms = sequence.ms.narrow;
        stepped.pair_bytes = pipelines_[static_cast<std::size_t>(Way::Streamed)].impl().report.stream.pair_bytes;
        return stepped;
    }

private:
    void check_same(std::size_t way, std::size_t frame) const {
        const View<const Contact> expected = pipelines_[0].impl().contacts, found = pipelines_[way].impl().contacts;
        if (found.size() == expected.size() &&
            (found.empty() || std::memcmp(found.data(), expected.data(), found.size() * sizeof(Contact)) == 0))
            return;
        throw std::runtime_error(std::string("frame ") + std::to_string(frame) + ": contacts of '" + way_names[way] +
                                 "' are not those of '" + way_names[0] + "'");
    }

    std::vector<Pipeline> pipelines_;
    std::size_t first_ = 0;
};

}  // namespace

Bench::Bench(const DeviceInfo& cpu) : one_(bench::parts_of(cpu, 1)), two_(bench::parts_of(cpu, 2)) {
    two_.impl().least_boxes_a_device = 1;  // both devices are to work however few the bodies are
}

Played Bench::compare(const Play& play, std::size_t every) {
    Pipelines pipelines(one_, two_, play);
    Played played{};
    {
        scenes::FallingBodies rest(play.kind, play.bodies, play.seed);
        while (rest.moving() > 0) rest.step();
        played.frames = rest.frame();
        played.rest = pipelines.step(rest.scene(), rest.frame());  // and builds the kernels
    }
    scenes::FallingBodies bodies(play.kind, play.bodies, play.seed);
    pipelines.step(bodies.scene(), 0);
    while (bodies.moving() > 0) {
        bodies.step();
        const std::size_t frame = bodies.frame();
        if (frame % every == 0)
            played.stepped.push_back(pipelines.step(bodies.scene(), frame));
        else if ((frame + 1) % every == 0)
            pipelines.step(bodies.scene(), frame);
    }
    return played;
}

std::vector<machines::PhaseLoad> Bench::loads(const Play& play) {
    PipelineOptions options;
    options.contacts = true;
    options.narrow_phase.contacts_per_pair = play.contacts_per_pair;
    options.broad_phase.measure_stages = true;
    Pipeline pipeline(one_, options);
    scenes::FallingBodies bodies(play.kind, play.bodies, play.seed);
    step_anew(pipeline, bodies.scene());
    std::vector<machines::PhaseLoad> loads;
    while (bodies.moving() > 0) {
        bodies.step();
        const StageTimes& ms = step_anew(pipeline, bodies.scene()).report().ms;
        loads.push_back({ms.broad / 1e3, ms.narrow / 1e3});
    }
    return loads;
}

}  // namespace clinch::phases
