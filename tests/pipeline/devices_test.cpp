// Steps on several devices, of one driver or of several: the bytes of one.
#include <catch2/catch.hpp>
#include <cstring>
#include <string>
#include <vector>

#include "clinch/pipeline.hpp"
#include "tests/device/devices.hpp"
#include "tests/narrow_phase/narrow_scenes.hpp"
#include "tests/random.hpp"
#include "tests/watchdog.hpp"

using namespace clinch;

namespace {

template <class T>
bool same(View<const T> p, View<const T> q) {
    return p.size() == q.size() && (p.empty() || std::memcmp(p.data(), q.data(), p.size() * sizeof(T)) == 0);
}

// A floor and bodies of a few shapes above it, some of which cannot move.
Scene heap(std::size_t n, test::Random& random) {
    Scene scene;
    std::vector<ShapeId> shapes;
    for (const std::size_t kind : {0u, 1u, 2u}) shapes.push_back(scene.add_shape(test::random_shape(kind, random)));
    scene.add_body({scene.add_shape(Plane{{0, 0, 1}, 0.3}), Pose{}});
    for (std::size_t i = 0; i < n; ++i) {
        Body body;
        body.shape = shapes[i % shapes.size()];
        body.pose.position = {random.between(0, 12), random.between(0, 12), random.between(0, 12)};
        body.pose.rotation = test::random_rotation(random);
        body.margin = i % 5 == 0 ? 0.1 : 0.0;
        body.motion = i % 4 == 0 ? Motion::Static : Motion::Dynamic;
        scene.add_body(body);
    }
    return scene;
}

}  // namespace

TEST_CASE("steps on several devices give the pairs and contacts of one", "[device][together]") {
    const test::Watchdog watchdog;
    const std::uint64_t seed = 71;
    INFO("seed " << seed);
    for (const std::uint32_t devices : {2u, 3u}) {
        Context together = test::several(devices);
        together.impl().least_boxes_a_device = 1;
        ContextOptions first;
        first.devices.indices = {together.devices()[together.impl().primary()].index};
        Context alone(first);
        for (const char* const algorithm : {"brute", "bvh"}) {
            PipelineOptions options;
            options.broad_phase.algorithm = algorithm;
            options.broad_phase.events = true;
            options.contacts = true;
            Pipeline on_all(together, options), on_one(alone, options);
            test::Random random(seed);
            Scene scene = heap(1500, random);
            for (int step = 0; step < 4; ++step) {
                INFO(devices << " devices, " << algorithm << ", step " << step);
                const StepResult& all = on_all.step(scene);
                const StepResult& one = on_one.step(scene);
                CHECK(one.pairs().size() > 500);
                CHECK(same(all.pairs(), one.pairs()));
                CHECK(same(all.added(), one.added()));
                CHECK(same(all.removed(), one.removed()));
                CHECK(same(all.boxes(), one.boxes()));
                CHECK(same(all.contacts(), one.contacts()));
                if (step == 0) CHECK(all.report().broad_split.size() == devices);  // later, those that pay
                CHECK(one.report().broad_split.empty());
                for (std::uint32_t i = 1; i < scene.row_count(); i += 3) {
                    Pose pose = scene.body({i}).pose;
                    pose.position.x += random.between(-0.3, 0.3);
                    scene.set_pose({i}, pose);
                }
            }
        }
    }
}
