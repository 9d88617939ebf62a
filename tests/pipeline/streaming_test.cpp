// Steps in which both phases are at work at once: the contacts of steps that find the pairs first, to the byte.
#include <algorithm>
#include <catch2/catch.hpp>
#include <functional>
#include <string>
#include <tuple>
#include <vector>

#include "clinch/pipeline.hpp"
#include "src/pipeline/pipeline_impl.hpp"
#include "tests/device/devices.hpp"
#include "tests/device/faults.hpp"
#include "tests/narrow_phase/narrow_scenes.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

// Bodies of a few shapes, some of which cannot move, groups and margins among them, above two planes.
Scene heap(std::size_t n, double edge, test::Random& random) {
    Scene scene;
    std::vector<ShapeId> shapes;
    for (const std::size_t kind : {0u, 1u, 2u, 5u}) shapes.push_back(scene.add_shape(test::random_shape(kind, random)));
    scene.add_body({scene.add_shape(Plane{{0, 0, 1}, 0.3}), Pose{}});
    scene.add_body({scene.add_shape(Plane{{1, 0, 0}, 0.2}), Pose{}});
    for (std::size_t i = 0; i < n; ++i) {
        Body body;
        body.shape = shapes[i % shapes.size()];
        body.pose.position = {random.between(0, edge), random.between(0, edge), random.between(0, edge)};
        body.pose.rotation = test::random_rotation(random);
        body.margin = i % 5 == 0 ? 0.1 : 0.0;
        body.motion = i % 4 == 0 ? Motion::Static : Motion::Dynamic;
        scene.add_body(body);
    }
    return scene;
}

void move_some(Scene& scene, test::Random& random) {
    for (std::uint32_t i = 2; i < scene.row_count(); i += 2) {
        Pose pose = scene.body({i}).pose;
        pose.position.x += random.between(-0.3, 0.3);
        scene.set_pose({i}, pose);
    }
}

PipelineOptions options_for(const std::string& algorithm, std::uint32_t points = 1) {
    PipelineOptions options;
    options.broad_phase.algorithm = algorithm;
    options.contacts = true;
    options.narrow_phase.contacts_per_pair = points;
    return options;
}

PipelineOptions streaming(PipelineOptions options) {
    options.streaming = true;
    return options;
}

Context first_of(const Context& together) {
    ContextOptions options;
    options.devices.indices = {together.devices()[together.impl().primary()].index};
    return Context(options);
}

using Forced = detail::PhaseStream::Forced;

void check_same(const StepResult& streamed, const StepResult& listed) {
    CHECK((test::bytes(streamed.contacts()) == test::bytes(listed.contacts())));
    CHECK((test::bytes(streamed.boxes()) == test::bytes(listed.boxes())));
    CHECK(streamed.pairs().empty());
    CHECK(streamed.report().pairs == listed.report().pairs);
    CHECK(streamed.report().contacts == listed.report().contacts);
    CHECK(streamed.report().bodies == listed.report().bodies);
    CHECK(streamed.report().algorithm == listed.report().algorithm);
    CHECK(streamed.report().skipped.pairs_filtered == listed.report().skipped.pairs_filtered);
    CHECK(streamed.narrow_report().pairs == listed.narrow_report().pairs);
    CHECK(streamed.narrow_report().buckets.size() == listed.narrow_report().buckets.size());
    const StreamWork& work = streamed.report().stream;
    CHECK(work.chunks * work.chunk_pairs + 128 > listed.report().pairs);
    CHECK(work.most_waiting * work.chunk_pairs * sizeof(Pair) <= work.pair_bytes);
    CHECK(listed.report().stream.chunks == 0);
}

}  // namespace

TEST_CASE("streamed steps have the contacts of listed ones, whoever does what", "[device][together]") {
    constexpr std::uint64_t seed = 91;
    INFO("seed " << seed);
    for (const std::uint32_t devices : {1u, 2u, 3u, 4u}) {
        Context together = test::several(devices);
        together.impl().least_boxes_a_device = 1;
        const Context& context = together;
        Context alone = first_of(together);
        for (const std::string& algorithm : test::names_for(alone.devices()[0])) {
            Pipeline on_all(together, streaming(options_for(algorithm))), on_one(alone, options_for(algorithm));
            test::Random random(seed);
            Scene scene = heap(700, 24.0, random);
            // The first counts its pairs first, the next know about how many there will be.
            const std::vector<Forced> ways{{}, {false, 0, 200}, {true, 1, 300}, {false, devices, 500}, {true, 2, 150}};
            for (const Forced& way : ways) {
                INFO(context.devices().size()
                     << " devices, " << algorithm << ", help " << !way.no_help << ", broad phase on "
                     << way.broad_devices << ", chunks of " << way.chunk_pairs);
                on_all.impl().phases->forced = way;
                const StepResult& streamed = on_all.step(scene);
                const StepResult& listed = on_one.step(scene);
                CHECK(listed.report().pairs > 1000);
                CHECK(listed.report().contacts > 300);
                check_same(streamed, listed);
                move_some(scene, random);
            }
        }
    }
}

TEST_CASE("random scenes stream as they are listed", "[device]") {
    constexpr std::uint64_t seed = 92;
    test::Random random(seed);
    Context together = test::several(3u);
    together.impl().least_boxes_a_device = 1;
    Context alone = first_of(together);
    Pipeline on_all(together, streaming(options_for("auto"))), on_one(alone, options_for("auto"));
    for (int trial = 0; trial < 60; ++trial) {
        const std::size_t n = trial < 12 ? static_cast<std::size_t>(trial) : 20 + random.below(1200);
        INFO("seed " << seed << ", trial " << trial << ", " << n << " bodies");
        const Scene scene = heap(n, random.between(1.0, 14.0), random);
        on_all.impl().phases->forced = {random.below(2) == 0, static_cast<unsigned>(random.below(4)),
                                        128 + random.below(2000)};
        check_same(on_all.step(scene), on_one.step(scene));
    }
}

TEST_CASE("manifolds, tolerances and precisions stream, too", "[device]") {
    constexpr std::uint64_t seed = 93;
    INFO("seed " << seed);
    Context together = test::several(2u);
    together.impl().least_boxes_a_device = 1;
    Context alone = first_of(together);
    std::vector<PipelineOptions> all{options_for("bvh", 4), options_for("bvh"), options_for("bvh"),
                                     options_for("bvh", 8)};
    all[1].narrow_phase.precision = 0.0;
    all[2].narrow_phase.precision = 1.0;
    all[3].narrow_phase.tolerance = 1e-5;
    for (const PipelineOptions& options : all) {
        INFO("points " << options.narrow_phase.contacts_per_pair << ", precision " << options.narrow_phase.precision);
        Pipeline on_all(together, streaming(options)), on_one(alone, options);
        on_all.impl().phases->forced.chunk_pairs = 256;
        test::Random random(seed);
        Scene scene = heap(900, 10.0, random);
        for (int step = 0; step < 2; ++step) {
            check_same(on_all.step(scene), on_one.step(scene));
            move_some(scene, random);
        }
    }
}

TEST_CASE("in any order a streamed step has the same contacts, those of a pair together", "[device]") {
    constexpr std::uint64_t seed = 99;
    INFO("seed " << seed);
    test::Random random(seed);
    Context together = test::several(3u);
    together.impl().least_boxes_a_device = 1;
    Context alone = first_of(together);
    const PipelineOptions sorted = options_for("bvh", 4);
    PipelineOptions any = streaming(sorted);
    any.broad_phase.order = Order::Any;
    Pipeline on_all(together, any), on_one(alone, sorted);
    on_all.impl().phases->forced = {false, 2, 256};
    const Scene scene = heap(900, 10.0, random);
    const StepResult& streamed = on_all.step(scene);
    std::vector<Contact> rows(streamed.contacts().begin(), streamed.contacts().end());
    REQUIRE(rows.size() > 500);
    CHECK(streamed.report().broad_split.size() == 2);
    const auto before = [](const Contact& p, const Contact& q) { return std::tie(p.a, p.b) < std::tie(q.a, q.b); };
    const auto pairs_in_a_row = [&] {
        std::size_t pairs = 1;
        for (std::size_t i = 1; i < rows.size(); ++i)
            pairs += before(rows[i - 1], rows[i]) || before(rows[i], rows[i - 1]) ? 1U : 0U;
        return pairs;
    };
    const std::size_t pairs = pairs_in_a_row();
    std::stable_sort(rows.begin(), rows.end(), before);  // those of a pair stay as they are
    CHECK(pairs == pairs_in_a_row());
    CHECK((test::bytes(View<const Contact>(rows)) == test::bytes(on_one.step(scene).contacts())));
}

TEST_CASE("steps stream on the host alone", "[host]") {
    constexpr std::uint64_t seed = 94;
    INFO("seed " << seed);
    Context context = Context::host_only();
    Pipeline streamed(context, streaming(options_for("auto"))), listed(context, options_for("auto"));
    test::Random random(seed);
    for (const std::size_t n : {0u, 1u, 5u, 300u, 900u}) {
        INFO(n << " bodies");
        Scene scene = heap(n, 8.0, random);
        check_same(streamed.step(scene), listed.step(scene));
    }
}

TEST_CASE("a step that streams is kept while nothing changes", "[device]") {
    Context context = test::several(2u);
    Pipeline pipeline(context, streaming(options_for("bvh")));
    test::Random random(95);
    const Scene scene = heap(600, 8.0, random);
    const std::string first = test::bytes(pipeline.step(scene).contacts());
    const StepResult& again = pipeline.step(scene);
    CHECK((test::bytes(again.contacts()) == first));
    CHECK(again.report().skipped.unchanged == scene.row_count());
    CHECK(again.report().stream.chunks == 0);
    CHECK(again.report().contacts > 0);
}

TEST_CASE("what does not go together with streaming is refused", "[host]") {
    Context context = Context::host_only();
    PipelineOptions options = streaming(options_for("auto"));
    options.contacts = false;
    CHECK_THROWS_WITH(Pipeline(context, options), Catch::Contains("contacts"));
    options = streaming(options_for("auto"));
    options.broad_phase.events = true;
    CHECK_THROWS_WITH(Pipeline(context, options), Catch::Contains("events"));
    options = streaming(options_for("auto"));
    options.warm_start = true;
    CHECK_THROWS_WITH(Pipeline(context, options), Catch::Contains("warm start"));
}

TEST_CASE("a limit of pairs, and pairs with meshes, end a step that streams", "[device]") {
    Context context = test::several(2u);
    context.impl().least_boxes_a_device = 1;
    test::Random random(96);
    Scene scene = heap(900, 8.0, random);
    PipelineOptions options = streaming(options_for("bvh"));
    options.broad_phase.max_pairs = 100;
    Pipeline limited(context, options);
    for (int turn = 0; turn < 2; ++turn) {
        try {
            limited.step(scene);
            FAIL("more pairs than allowed were taken");
        } catch (const Error& error) {
            CHECK(error.code() == ErrorCode::LimitExceeded);
        }
    }
    Pipeline pipeline(context, streaming(options_for("bvh")));
    pipeline.impl().phases->forced.chunk_pairs = 200;
    const std::string right = test::bytes(pipeline.step(scene).contacts());
    Scene wrong = scene;
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    wrong.add_body({wrong.add_shape(mesh), Pose{{4, 4, 4}}});
    for (int turn = 0; turn < 2; ++turn) {
        try {
            pipeline.step(wrong);
            FAIL("a pair with a mesh was taken");
        } catch (const Error& error) {
            CHECK(error.code() == ErrorCode::InvalidArgument);
        }
    }
    CHECK((test::bytes(pipeline.step(scene).contacts()) == right));
}
