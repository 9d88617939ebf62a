// What a device answers through NarrowPhase, in float32 alone and in float64 alone.
#include <algorithm>
#include <cmath>
#include <optional>

#include "bench/accuracy/candidate.hpp"
#include "clinch/narrow_phase.hpp"

namespace clinch::accuracy {
namespace {

Shape shape_of(const test::TrueBody& body) {
    const auto& s = body.size;
    switch (body.kind) {
        case test::Kind::sphere:
            return Sphere{s[0]};
        case test::Kind::box:
            return Box{{s[0], s[1], s[2]}};
        case test::Kind::capsule:
            return Capsule{s[0], s[1]};
        case test::Kind::cylinder:
            return Cylinder{s[0], s[1]};
        case test::Kind::cone:
            return Cone{s[0], s[1]};
        case test::Kind::plane:
            return Plane{{body.normal[0], body.normal[1], body.normal[2]}, s[0]};
        default: {
            Hull hull;
            for (const auto& p : body.points) hull.points.push_back({p[0], p[1], p[2]});
            return hull;
        }
    }
}

class DeviceRoutine final : public Candidate {
public:
    DeviceRoutine(Title title, Context& context, double precision)
        : Candidate(std::move(title)), narrow_(context, options_of(precision)) {}

    void load(const std::vector<test::TruePair>& pairs, std::size_t copies) override {
        scene_.emplace();
        pairs_.clear();
        std::vector<ShapeId> shapes;
        double far = 0;
        for (const test::TruePair& pair : pairs) {
            shapes.push_back(scene_->add_shape(shape_of(pair.a)));
            shapes.push_back(scene_->add_shape(shape_of(pair.b)));
            far = std::max(far, test::size_of(pair));
        }
        for (std::size_t i = 0; i < pairs.size() * copies; ++i) {
            const std::size_t at = i % pairs.size();
            const std::uint32_t a = add(pairs[at].a, shapes[2 * at], far),
                                b = add(pairs[at].b, shapes[2 * at + 1], far);
            pairs_.push_back({a, b});
        }
        first_copy_ = pairs.size();
    }
    double run() override {
        contacts_ = narrow_.find(*scene_, pairs_);
        return narrow_.report().ms.routines * 1e-3;
    }
    std::vector<Found> found() const override {
        // A pair without a contact would be one that the margins did not reach.
        std::vector<Found> all(first_copy_, Found{NAN, NAN, {}, true});
        for (const Contact& c : contacts_)
            if (c.a / 2 < first_copy_) all[c.a / 2] = {c.distance, c.error, {c.normal.x, c.normal.y, c.normal.z}, true};
        return all;
    }

private:
    static NarrowPhaseOptions options_of(double precision) {
        NarrowPhaseOptions options;
        options.precision = precision;
        options.measure_stages = true;
        return options;
    }
    std::uint32_t add(const test::TrueBody& body, ShapeId shape, double margin) {
        Body b;
        b.shape = shape;
        b.pose = {{body.position[0], body.position[1], body.position[2]},
                  {body.rotation[0], body.rotation[1], body.rotation[2], body.rotation[3]}};
        b.margin = margin;
        return scene_->add_body(b).index;
    }

    NarrowPhase narrow_;
    std::optional<Scene> scene_;
    std::vector<Pair> pairs_;
    View<const Contact> contacts_;
    std::size_t first_copy_ = 0;
};

}  // namespace

void add_device(Context& context, Candidates& candidates) {
    candidates.push_back(std::make_unique<DeviceRoutine>(Title{"own", "device", 32, -1}, context, 0.0));
    candidates.push_back(std::make_unique<DeviceRoutine>(Title{"own", "device", 64, -1}, context, 1.0));
}

}  // namespace clinch::accuracy
