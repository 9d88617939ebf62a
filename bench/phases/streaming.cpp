#include "bench/phases/streaming.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
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

// Frames in a row, as programs step them: some to begin with, then some that are measured.
constexpr std::size_t unmeasured = 2, in_a_row = 4;

// A way with bodies of its own, which fall as those of the others do.
class Player {
public:
    Player(Context& context, const Play& play, Way way)
        : pipeline_(make(context, play, way)), bodies_(play.kind, play.bodies, play.seed) {}

    // Goes on to that frame without a step.
    void skip_to(std::size_t frame) {
        while (bodies_.frame() < frame) bodies_.step();
    }
    double step(const Scene& scene) {
        const detail::Stopwatch watch;
        step_anew(pipeline_, scene);
        return watch.ms();
    }
    // On to the next frame, and a step there; how long that took.
    double next() {
        bodies_.step();
        return step(bodies_.scene());
    }
    View<const Contact> contacts() const { return pipeline_.impl().contacts; }
    const Report& report() const { return pipeline_.impl().report; }

private:
    Pipeline pipeline_;
    scenes::FallingBodies bodies_;
};

// All ways, one after the other, beginning with another one each time.
class Players {
public:
    Players(Context& one, Context& two, const Play& play) {
        for (std::size_t i = 0; i < ways; ++i) {
            const auto way = static_cast<Way>(i);
            players_.push_back(std::make_unique<Player>(way == Way::Sequence ? one : two, play, way));
        }
    }

    // A scene of its own, as frame number `frame`.
    Frame step(const Scene& scene, std::size_t frame) {
        std::vector<Frame> frames{{frame, 0, 0, {}, 0.0, 0.0, 0}};
        play(frames, [&](Player& player) { return player.step(scene); });
        return frames.front();
    }

    // Frames in a row, the first of them number `first`.
    std::vector<Frame> step_from(std::size_t first) {
        std::vector<Frame> frames;
        for (std::size_t k = 0; k < in_a_row; ++k) frames.push_back({first + k, 0, 0, {}, 0.0, 0.0, 0});
        for (const auto& player : players_) player->skip_to(first - 1 - unmeasured);
        play(
            frames, [](Player& player) { return player.next(); },
            [](Player& player) {
                for (std::size_t k = 0; k < unmeasured; ++k) player.next();
            });
        return frames;
    }

private:
    template <class Step, class Begin>
    void play(std::vector<Frame>& frames, const Step& step, const Begin& begin) {
        found_.clear();
        for (std::size_t i = 0; i < ways; ++i) {
            const std::size_t way = (first_ + i) % ways;
            Player& player = *players_[way];
            begin(player);
            for (std::size_t k = 0; k < frames.size(); ++k) {
                frames[k].ms[way] = step(player);
                note(static_cast<Way>(way), player, frames[k]);
                check_same(k, way, frames[k].frame);
            }
        }
        first_ = (first_ + 1) % ways;
    }
    template <class Step>
    void play(std::vector<Frame>& frames, const Step& step) {
        play(frames, step, [](Player&) {});
    }
    static void note(Way way, const Player& player, Frame& frame) {
        const Report& report = player.report();
        if (way == Way::Streamed) frame.pair_bytes = report.stream.pair_bytes;
        if (way != Way::Sequence) return;
        frame.pairs = report.pairs;
        frame.contacts = report.contacts;
        frame.broad_ms = report.ms.broad;
        frame.narrow_ms = report.ms.narrow;
    }
    // Against what the first way has found in that one of the frames in a row.
    void check_same(std::size_t k, std::size_t way, std::size_t frame) {
        const View<const Contact> contacts = players_[way]->contacts();
        if (found_.size() == k) {
            found_.emplace_back(contacts.begin(), contacts.end());
            return;
        }
        const std::vector<Contact>& expected = found_[k];
        if (contacts.size() == expected.size() &&
            (contacts.empty() || std::memcmp(contacts.data(), expected.data(), contacts.size() * sizeof(Contact)) == 0))
            return;
        throw std::runtime_error("frame " + std::to_string(frame) + ": contacts of '" + way_names[way] +
                                 "' are not those of '" + way_names[first_] + "'");
    }

    std::vector<std::unique_ptr<Player>> players_;
    std::vector<std::vector<Contact>> found_;
    std::size_t first_ = 0;
};

}  // namespace

Bench::Bench(const DeviceInfo& cpu) : one_(bench::parts_of(cpu, 1)), two_(bench::parts_of(cpu, 2)) {
    two_.impl().least_boxes_a_device = 1;  // both devices are to work however few the bodies are
}

Played Bench::compare(const Play& play, std::size_t every) {
    Players players(one_, two_, play);
    Played played{};
    {
        scenes::FallingBodies rest(play.kind, play.bodies, play.seed);
        while (rest.moving() > 0) rest.step();
        played.frames = rest.frame();
        played.rest = players.step(rest.scene(), rest.frame());  // and builds the kernels
    }
    const std::size_t stride = std::max(every * in_a_row, unmeasured + in_a_row);
    for (std::size_t first = unmeasured + 1; first + in_a_row <= played.frames; first += stride)
        for (const Frame& frame : players.step_from(first)) played.stepped.push_back(frame);
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
