// clinch itself: NarrowPhase::find and touching on the devices that CLINCH_DEVICES and the drivers give.
#include "bench/peers/narrow/peer.hpp"
#include "clinch/context.hpp"
#include "clinch/narrow_phase.hpp"

namespace clinch::peers::narrow {
namespace {

NarrowPhaseOptions options_of(double precision, std::uint32_t points, bool stages) {
    NarrowPhaseOptions options;
    options.contacts_per_pair = points;
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
    Clinch(const Batch& batch, Question question, const Way& way)
        : scene_(scene_of(batch, margin_for(batch, question))),
          only_touching_(question == Question::Touching),
          warm_(way.warm),
          narrow_phase_(context_, options_of(way.precision, way.points, false)),
          in_stages_(context_, options_of(way.precision, way.points, true)),
          answers_(batch.pairs()) {
        for (std::uint32_t i = 0; i < batch.pairs(); ++i) pairs_.push_back({2 * i, 2 * i + 1});
    }

    void run() override {
        if (only_touching_)
            touching_ = narrow_phase_.touching(scene_, pairs_, kept());
        else
            contacts_ = narrow_phase_.find(scene_, pairs_, kept());
    }

    // A pair's deepest contact counts.
    const std::vector<Answer>& answers() override {
        for (Answer& answer : answers_) {
            answer = {};
            answer.given = true;
        }
        for (const Pair& pair : touching_) answers_[pair.a / 2].touching = true;
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
        if (only_touching_)
            in_stages_.touching(scene_, pairs_, kept());
        else
            in_stages_.find(scene_, pairs_, kept());
        return in_stages_.report().ms.routines + in_stages_.report().ms.manifolds;
    }

private:
    WarmStart* kept() { return warm_ ? &kept_ : nullptr; }

    Context context_;
    Scene scene_;
    bool only_touching_, warm_;
    WarmStart kept_;
    NarrowPhase narrow_phase_, in_stages_;
    std::vector<Pair> pairs_;
    View<const Contact> contacts_;
    View<const Pair> touching_;
    std::vector<Answer> answers_;
};

}  // namespace

std::unique_ptr<Peer> make_clinch(const Batch& batch, Question question, const Way& way) {
    if (way.points > 1 && question != Question::Contact) return nullptr;
    return std::make_unique<Clinch>(batch, question, way);
}

}  // namespace clinch::peers::narrow
