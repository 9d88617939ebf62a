// Step after step of one scene in which little changes.
#include <catch2/catch.hpp>
#include <vector>

#include "clinch/error.hpp"
#include "clinch/pipeline.hpp"
#include "tests/device/devices.hpp"
#include "tests/pair_lists.hpp"
#include "tests/random.hpp"

using namespace clinch;
using test::copy;
using test::without;

namespace {

Scene spheres(std::size_t n, test::Random& random) {
    Scene scene;
    Body body;
    body.shape = scene.add_shape(Sphere{0.5});
    for (std::size_t i = 0; i < n; ++i) {
        body.pose.position = {random.between(0, 35), random.between(0, 35), random.between(0, 35)};
        body.motion = i % 3 == 0 ? Motion::Static : Motion::Dynamic;
        scene.add_body(body);
    }
    body.shape = scene.add_shape(Plane{{0, 0, 1}, 0.0});
    scene.add_body(body);
    return scene;
}

// A frame in which `count` bodies move a little, and a few fall asleep, wake up or jump.
void change(Scene& scene, std::size_t count, bool filters, test::Random& random) {
    for (std::size_t k = 0; k < count; ++k) {
        const BodyId id{static_cast<std::uint32_t>(random.below(scene.row_count() - 1))};
        Body body = scene.body(id);
        const double reach = random.below(50) == 0 ? 5.0 : 0.02;
        body.pose.position.x += random.between(-reach, reach);
        body.pose.position.z += random.between(-reach, reach);
        scene.set_pose(id, body.pose);
        if (filters && k % 10 == 0)
            scene.set_motion({id.index + 1}, random.below(2) == 0 ? Motion::Sleeping : Motion::Dynamic);
    }
}

}  // namespace

TEST_CASE("steps with few changes are those of a fresh search, with events", "[device]") {
    test::Random random(12);
    Scene scene = spheres(12000, random);
    Context context, host = Context::host_only();
    PipelineOptions options;
    options.broad_phase.events = true;
    Pipeline pipeline(context, options);
    std::vector<Pair> last;
    int kept = 0;
    for (int frame = 0; frame < 12; ++frame) {
        INFO("frame " << frame);
        const StepResult& result = pipeline.step(scene);
        Pipeline fresh(host);
        const std::vector<Pair> now = copy(result.pairs()), expected = copy(fresh.step(scene).pairs());
        CHECK(now == expected);
        CHECK(copy(result.added()) == without(now, last));
        CHECK(copy(result.removed()) == without(last, now));
        kept += result.report().algorithm == "incremental" ? 1 : 0;
        last = now;
        if (frame == 5) {  // nothing changes
            CHECK(copy(pipeline.step(scene).pairs()) == now);
            CHECK(result.added().empty());
            CHECK(result.removed().empty());
            CHECK(result.report().skipped.unchanged == scene.row_count());
            CHECK(result.report().skipped.bounds == scene.row_count());
        }
        if (frame == 7) scene.remove_body({40});
        if (frame == 8) scene.add_body(scene.body({41}));
        change(scene, frame == 9 ? 6000 : 60, frame % 3 == 1, random);
    }
    PipelineOptions any_order = options;
    any_order.broad_phase.order = Order::Any;
    CHECK_THROWS_AS(Pipeline(context, any_order), Error);
    CHECK((kept >= 6 || !list_devices()[0].quirks.empty()));
}
