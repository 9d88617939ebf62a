// clinch itself: NarrowPhase::find on the devices that CLINCH_DEVICES and the drivers give.
#include "bench/peers/narrow/peer.hpp"
#include "clinch/context.hpp"
#include "clinch/narrow_phase.hpp"

namespace clinch::peers::narrow {
namespace {

NarrowPhaseOptions options_of(double precision, bool stages) {
    NarrowPhaseOptions options;
    options.precision = precision;
    options.measure_stages = stages;
    return options;
}

/// Gaps are up to 0.1 of the pair's size: what the two margins reach together, and a little.
double margin_for(const Batch& batch, Question question) {
    return question == Question::Distance ? 0.0501 * batch.largest_size : 0.0;
}

class Clinch : public Peer {
public:
    Clinch(const Batch& batch, Question question, double precision)
        : scene_(scene_of(batch, margin_for(batch, question))),
          narrow_phase_(context_, options_of(precision, false)),
          in_stages_(context_, options_of(precision, true)),
          answers_(batch.pairs()) {
        for (std::uint32_t i = 0; i < batch.pairs(); ++i) pairs_.push_back({2 * i, 2 * i + 1});
    }

    void run() override { contacts_ = narrow_phase_.find(scene_, pairs_); }

    // A pair's deepest contact counts.
    const std::vector<Answer>& answers() override {
        for (Answer& answer : answers_) {
            answer = {};
            answer.given = true;
        }
        for (const Contact& c : contacts_) {
            Answer& answer = answers_[c.a / 2];
            if (answer.distance <= c.distance) continue;
            answer.touching = c.distance <= 0.0;
            answer.distance = c.distance;
            answer.normal = c.normal;
            answer.point = c.on_a;
            answer.other = c.on_b;
        }
        return answers_;
    }

    double routines_ms() override {
        in_stages_.find(scene_, pairs_);
        return in_stages_.report().ms.routines;
    }

private:
    Context context_;
    Scene scene_;
    NarrowPhase narrow_phase_, in_stages_;
    std::vector<Pair> pairs_;
    View<const Contact> contacts_;
    std::vector<Answer> answers_;
};

}  // namespace

std::unique_ptr<Peer> make_clinch(const Batch& batch, Question question, double precision) {
    return std::make_unique<Clinch>(batch, question, precision);
}

}  // namespace clinch::peers::narrow
