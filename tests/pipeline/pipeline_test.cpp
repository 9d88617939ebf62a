#include "clinch/pipeline.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "clinch/error.hpp"
#include "tests/broad_phase/oracle.hpp"
#include "tests/device/devices.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

PipelineOptions with_algorithm(const std::string& name) {
    PipelineOptions options;
    options.broad_phase.algorithm = name;
    return options;
}

// Bodies of every shape class with random poses, filters, margins; a few planes; a few meaningless ones.
Scene random_scene(std::size_t n, test::Random& random) {
    Scene scene;
    std::vector<ShapeId> shapes{scene.add_shape(Sphere{0.5}),
                                scene.add_shape(Box{{0.3, 0.4, 0.5}}),
                                scene.add_shape(Capsule{0.2, 0.5}),
                                scene.add_shape(Cylinder{0.3, 0.4}),
                                scene.add_shape(Cone{0.4, 0.4}),
                                scene.add_shape(Hull{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}),
                                scene.add_shape(Mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}),
                                scene.add_shape(Sphere{-1.0})};
    const ShapeId plane = scene.add_shape(Plane{{0.6, 0.0, 0.8}, -2.0});
    const double edge = 1.7 * std::cbrt(static_cast<double>(n));
    for (std::size_t i = 0; i < n; ++i) {
        Body body;
        body.shape = i % 100 == 50 ? plane : shapes[random.below(i % 30 == 0 ? shapes.size() : shapes.size() - 1)];
        body.pose.position = {random.between(0, edge), random.between(0, edge), random.between(0, edge)};
        Quat q{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
        const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
        body.pose.rotation = {q.w / length, q.x / length, q.y / length, q.z / length};
        body.group = 1u << random.below(3);
        body.mask = static_cast<std::uint32_t>(random.below(8)) | 1u;
        body.motion = static_cast<Motion>(random.below(4));
        body.margin = random.between(0, 0.1);
        scene.add_body(body);
    }
    return scene;
}

bool is_plane(const Scene& scene, std::size_t i) {
    return std::holds_alternative<Plane>(scene.shape({scene.columns().shape[i]}));
}

// Whether the box reaches into the half-space of body `p`, with long doubles; `slack` widens it.
bool reaches(const Scene& scene, std::size_t p, const Aabb& box, long double slack) {
    const SceneColumns c = scene.columns();
    const Plane& plane = std::get<Plane>(scene.shape({c.shape[p]}));
    const Quat& q = c.rotation[p];
    const long double w = q.w, x = q.x, y = q.y, z = q.z;
    const long double v[3] = {plane.normal.x, plane.normal.y, plane.normal.z};
    const long double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                                 {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                                 {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    const long double at[3] = {c.position[p].x, c.position[p].y, c.position[p].z};
    long double lowest = -static_cast<long double>(plane.offset) - static_cast<long double>(c.margin[p]) - slack;
    for (int d = 0; d < 3; ++d) {
        const long double n = r[d][0] * v[0] + r[d][1] * v[1] + r[d][2] * v[2];
        lowest += n * ((n >= 0 ? static_cast<long double>(box.min[d]) : static_cast<long double>(box.max[d])) - at[d]);
    }
    return lowest <= 0;
}

void check_step(const Scene& scene, const StepResult& result) {
    const View<const Aabb> boxes = result.boxes();
    REQUIRE(boxes.size() == scene.row_count());
    std::vector<Motion> motion(scene.columns().motion.begin(), scene.columns().motion.end());
    for (std::size_t i = 0; i < motion.size(); ++i)
        if (is_plane(scene, i)) motion[i] = Motion::Static;
    const FilterColumns filters{scene.columns().group.data(), scene.columns().mask.data(), motion.data()};
    std::vector<bool> rejected(scene.row_count(), false);
    for (const Rejection& r : scene.rejected()) rejected[r.body] = true;
    CHECK(result.report().rejected.size() == scene.rejected().size());

    const View<const Pair> found = result.pairs();
    CHECK(std::is_sorted(found.begin(), found.end()));
    std::size_t at = 0, wrong = 0;
    for (std::uint32_t a = 0; a < boxes.size(); ++a)
        for (std::uint32_t b = a + 1; b < boxes.size(); ++b) {
            const bool here = at < found.size() && found[at] == Pair{a, b};
            at += here ? 1U : 0U;
            bool must = false, may = false;
            if (is_plane(scene, a) != is_plane(scene, b)) {
                const std::uint32_t plane = is_plane(scene, a) ? a : b, body = plane == a ? b : a;
                const bool usable = test::is_box(boxes[body]) && !rejected[plane];
                must = usable && reaches(scene, plane, boxes[body], 0.0L);
                may = usable && reaches(scene, plane, boxes[body], 1e-3L);
            } else {
                must = may = !test::apart(boxes[a], boxes[b]);
            }
            if (!test::passes(filters, a, b)) must = may = false;
            if ((must && !here) || (here && !may)) ++wrong;
        }
    CHECK(wrong == 0);
    CHECK(at == found.size());
}

}  // namespace

TEST_CASE("steps of scenes with every shape class, planes and filters", "[device]") {
    const std::uint64_t seed = 41;
    INFO("seed " << seed);
    test::Random random(seed);
    for (const std::size_t n : {3u, 200u, 1500u}) {
        Scene scene = random_scene(n, random);
        for (const std::string& name : test::names_for(list_devices()[0])) {
            INFO("n " << n << ", " << name);
            Context context;
            Pipeline pipeline(context, with_algorithm(name));
            check_step(scene, pipeline.step(scene));
        }
    }
}

TEST_CASE("host and device steps give the same bytes, and so do changed scenes", "[device][small]") {
    const std::uint64_t seed = 42;
    INFO("seed " << seed);
    test::Random random(seed);
    Scene scene = random_scene(150, random);
    Context context;
    Pipeline on_device(context, with_algorithm("brute")), on_host(context, with_algorithm("host-brute"));
    for (int step = 0; step < 5; ++step) {
        const StepResult& d = on_device.step(scene);
        const StepResult& h = on_host.step(scene);
        REQUIRE(d.boxes().size() == h.boxes().size());
        CHECK(std::memcmp(d.boxes().data(), h.boxes().data(), d.boxes().size() * sizeof(Aabb)) == 0);
        REQUIRE(d.pairs().size() == h.pairs().size());
        CHECK(std::equal(d.pairs().begin(), d.pairs().end(), h.pairs().begin()));
        CHECK(d.report().skipped.bounds == h.report().skipped.bounds);
        for (int change = 0; change < 5; ++change) {
            const BodyId id{static_cast<std::uint32_t>(random.below(scene.row_count()))};
            if (!scene.contains(id)) continue;
            Body body = scene.body(id);
            body.pose.position.x += 0.5;
            body.motion = static_cast<Motion>(random.below(4));
            scene.set_body(id, body);
        }
        if (step == 2) scene.remove_body({7});
        if (step == 3) scene.add_body(scene.body({9}));
    }
}

TEST_CASE("only what changed is computed again", "[device]") {
    test::Random random(43);
    Scene scene = random_scene(1000, random);
    const std::size_t rows = scene.row_count();
    for (const std::string& name : test::names_for(list_devices()[0])) {
        INFO(name);
        Context context;
        Pipeline pipeline(context, with_algorithm(name));
        CHECK(pipeline.step(scene).report().skipped.bounds == 0);
        CHECK(pipeline.step(scene).report().skipped.bounds == rows);
        scene.set_pose({5}, {{1, 2, 3 + random.between(0, 1)}, {}});
        CHECK(pipeline.step(scene).report().skipped.bounds == rows - 1);
        const Scene copy = scene;
        CHECK(pipeline.step(copy).report().skipped.bounds == 0);
    }
}

TEST_CASE("a scene of 5 bodies opens no device and builds no kernel", "[device][small]") {
    Scene scene;
    const ShapeId ball = scene.add_shape(Sphere{0.5});
    for (int i = 0; i < 5; ++i) scene.add_body({ball, Pose{{0.9 * i, 0, 0}, {}}});
    Context context;
    Pipeline pipeline(context);
    const StepResult& result = pipeline.step(scene);
    CHECK(result.pairs().size() == 4);
    CHECK(result.report().algorithm == "host-sweep");
    for (const DeviceReport& report : context.report()) {
        CHECK_FALSE(report.opened);
        CHECK(report.modules_built.empty());
        CHECK(report.peak_bytes == 0);
    }
}

TEST_CASE("a device builds only the kernels that a scene needs, and one device only is opened", "[device]") {
    Scene scene;
    const ShapeId ball = scene.add_shape(Sphere{0.5});
    for (int i = 0; i < 5; ++i) scene.add_body({ball, Pose{{0.9 * i, 0, 0}, {}}});
    ContextOptions options;
    options.use_kernel_cache = false;
    Context context(options);
    Pipeline pipeline(context, with_algorithm("brute"));
    CHECK(pipeline.step(scene).pairs().size() == 4);
    std::size_t opened = 0;
    for (const DeviceReport& report : context.report()) {
        if (!report.opened) {
            CHECK(report.modules_built.empty());
            continue;
        }
        ++opened;
        CHECK(report.modules_built ==
              std::vector<std::string>{"scene/bounds", "broad_phase/columns", "broad_phase/brute", "primitives/scan"});
    }
    CHECK(opened == 1);
    // A plane needs one module more.
    scene.add_body({scene.add_shape(Plane{}), Pose{}});
    CHECK(pipeline.step(scene).pairs().size() == 9);
    CHECK(context.report()[context.impl().primary()].modules_built.back() == "broad_phase/planes");
}

TEST_CASE("planes: axis-aligned ones are exact, far ones keep what they touch", "[host]") {
    Context context = Context::host_only();
    for (const double far : {0.0, 1e7}) {
        INFO("at " << far);
        Scene scene;
        scene.add_body({scene.add_shape(Plane{{0, 0, 1}, 0}), Pose{{far, far, 0}, {}}});
        const ShapeId ball = scene.add_shape(Sphere{0.5});
        scene.add_body({ball, Pose{{far, far, 0.5}, {}}});                                   // touches
        scene.add_body({ball, Pose{{far, far + 9, 0.501}, {}}});                             // does not
        scene.add_body({ball, Pose{{far, far + 18, -70}, {}}});                              // far inside
        scene.add_body({scene.add_shape(Plane{{0, 0, -1}, 0}), Pose{{far, far, 0.5}, {}}});  // z >= 0.5
        Pipeline pipeline(context);
        const View<const Pair> pairs = pipeline.step(scene).pairs();
        const std::vector<Pair> expected{{0, 1}, {0, 3}, {1, 4}, {2, 4}};
        REQUIRE(pairs.size() == expected.size());
        CHECK(std::equal(pairs.begin(), pairs.end(), expected.begin()));
    }
}

TEST_CASE("an empty scene, and a scene emptied, give no pairs", "[device][small]") {
    Context context;
    for (const std::string& name : test::names_for(list_devices()[0])) {
        INFO(name);
        Pipeline pipeline(context, with_algorithm(name));
        Scene scene;
        CHECK(pipeline.step(scene).pairs().empty());
        CHECK(pipeline.step(scene).boxes().empty());
        const ShapeId box = scene.add_shape(Box{});
        const BodyId one = scene.add_body({box});
        const BodyId two = scene.add_body({box});
        CHECK(pipeline.step(scene).pairs().size() == 1);
        scene.remove_body(one);
        scene.remove_body(two);
        CHECK(pipeline.step(scene).pairs().empty());
        CHECK(pipeline.step(scene).report().bodies == 0);
    }
}

TEST_CASE("after an error the next step starts afresh", "[device]") {
    Scene scene;
    const ShapeId box = scene.add_shape(Box{});
    for (int i = 0; i < 100; ++i) scene.add_body({box});
    Context context;
    for (const std::string& name : test::names_for(list_devices()[0])) {
        PipelineOptions options = with_algorithm(name);
        options.broad_phase.max_pairs = 1000;
        Pipeline pipeline(context, options);
        CHECK_THROWS_AS(pipeline.step(scene), Error);
        Scene small = scene;
        for (std::uint32_t i = 40; i < 100; ++i) small.remove_body({i});
        const StepResult& result = pipeline.step(small);
        CHECK(result.pairs().size() == 780);
        CHECK(result.report().skipped.bounds == 0);
    }
}
