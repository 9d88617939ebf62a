#include "clinch/scene.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "clinch/error.hpp"
#include "src/scene/same_bits.hpp"
#include "src/scene/scene_impl.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

// A scene of `count` unit spheres at x = 0, 1, 2, ...
Scene row_of_balls(std::size_t count) {
    Scene scene;
    Body body;
    body.shape = scene.add_shape(Sphere{0.5});
    scene.add_bodies(count, body);
    std::vector<double> xyz(3 * count);
    for (std::size_t i = 0; i < count; ++i) xyz[3 * i] = static_cast<double>(i);
    scene.set_positions(xyz.data(), count);
    return scene;
}

std::vector<std::uint32_t> changed(const Scene& scene, std::uint64_t since) {
    std::vector<std::uint32_t> rows;
    scene.changed_rows(since, rows);
    return rows;
}

template <class F>
void check_refused(Scene& scene, const F& call, const std::string& words) {
    const std::uint64_t version = scene.version();
    try {
        call();
        FAIL("no error");
    } catch (const Error& error) {
        CHECK(error.code() == ErrorCode::InvalidArgument);
        CHECK_THAT(error.what(), Catch::Contains(words));
    }
    CHECK(scene.version() == version);
}

}  // namespace

TEST_CASE("a new scene is empty", "[host]") {
    const Scene scene;
    CHECK(scene.row_count() == 0);
    CHECK(scene.body_count() == 0);
    CHECK(scene.shape_count() == 0);
    CHECK(scene.rejected().empty());
    CHECK(changed(scene, 0).empty());
    CHECK_FALSE(scene.contains({0}));
    CHECK(scene.impl().filters_default());
}

TEST_CASE("a body comes back as it was given", "[host]") {
    Scene scene;
    Body body;
    body.shape = scene.add_shape(Box{{1, 2, 3}});
    body.pose = {{0.1, -0.2, 1e7}, {0.5, 0.5, -0.5, 0.5}};
    body.velocity = {1, 2, 3};
    body.angular_velocity = {4, 5, 6};
    body.motion = Motion::Sleeping;
    body.group = 6;
    body.mask = 9;
    body.margin = 0.3;
    const BodyId id = scene.add_body(body);
    const auto check = [&](const Body& got, const Body& want) {
        CHECK(got.shape.index == want.shape.index);
        CHECK(detail::same_bits(got.pose, want.pose));
        CHECK(detail::same_bits(got.velocity, want.velocity));
        CHECK(detail::same_bits(got.angular_velocity, want.angular_velocity));
        CHECK(got.motion == want.motion);
        CHECK(got.group == want.group);
        CHECK(got.mask == want.mask);
        CHECK(got.margin == want.margin);
    };
    check(scene.body(id), body);
    Body other;
    other.shape = scene.add_shape(Sphere{2});
    scene.set_body(id, other);
    check(scene.body(id), other);
    scene.set_body(id, body);
    check(scene.body(id), body);
    CHECK(std::get<Box>(scene.shape(body.shape)).half_extents.z == 3.0);
    const SceneColumns columns = scene.columns();
    CHECK(columns.position[0].z == 1e7);
    CHECK(columns.motion[0] == Motion::Sleeping);
    CHECK(columns.alive.size() == 1);
}

TEST_CASE("removed rows are used again, the last one first", "[host]") {
    Scene scene = row_of_balls(5);
    const Body body = scene.body({0});
    scene.remove_body({1});
    scene.remove_body({3});
    CHECK(scene.row_count() == 5);
    CHECK(scene.body_count() == 3);
    CHECK_FALSE(scene.contains({3}));
    CHECK(scene.columns().alive[1] == 0);
    CHECK(scene.columns().position[1].x == 1.0);
    CHECK(scene.add_body(body).index == 3);
    CHECK(scene.add_body(body).index == 1);
    CHECK(scene.add_body(body).index == 5);
    CHECK(scene.add_bodies(2, body).index == 6);
    CHECK(scene.body_count() == 8);
    CHECK(scene.contains({7}));
    CHECK_FALSE(scene.contains({8}));
}

TEST_CASE("wrong calls throw and change nothing", "[host]") {
    Scene scene = row_of_balls(4);
    scene.remove_body({2});
    const double numbers[16] = {};
    const std::uint32_t shapes[4] = {0, 7, 0, 0};
    const Motion motions[4] = {};
    check_refused(
        scene, [&] { scene.remove_body({2}); }, "body 2 does not exist");
    check_refused(
        scene, [&] { scene.remove_body({4}); }, "body 4 does not exist");
    check_refused(
        scene, [&] { (void)scene.body({2}); }, "body 2 does not exist");
    check_refused(
        scene, [&] { scene.set_pose({9}, {}); }, "body 9 does not exist");
    check_refused(
        scene, [&] { scene.set_motion({2}, Motion::Static); }, "body 2 does not exist");
    check_refused(
        scene, [&] { scene.set_filter({2}, 1, 1); }, "body 2 does not exist");
    check_refused(
        scene, [&] { scene.set_body({2}, {}); }, "body 2 does not exist");
    Body body;
    body.shape = {1};
    check_refused(
        scene, [&] { scene.add_body(body); }, "shape 1 does not exist: the scene has 1 shapes");
    check_refused(
        scene, [&] { scene.add_bodies(3, body); }, "shape 1 does not exist");
    check_refused(
        scene, [&] { scene.set_body({0}, body); }, "shape 1 does not exist");
    check_refused(
        scene, [&] { scene.set_shape({1}, Sphere{}); }, "shape 1 does not exist");
    check_refused(
        scene, [&] { (void)scene.shape({1}); }, "shape 1 does not exist");
    check_refused(
        scene, [&] { scene.set_positions(numbers, 3); }, "row 2 does not exist: its body was removed");
    check_refused(
        scene, [&] { scene.set_positions(numbers, 2, 3); }, "the scene has 4 rows");
    check_refused(
        scene, [&] { scene.set_positions(numbers, SIZE_MAX, 2); }, "the scene has 4 rows");
    check_refused(
        scene, [&] { scene.set_rotations(numbers, 1, SIZE_MAX); }, "the scene has 4 rows");
    check_refused(
        scene, [&] { scene.set_velocities(static_cast<double*>(nullptr), 1); }, "null pointer");
    check_refused(
        scene, [&] { scene.set_shapes(shapes, 2); }, "shape 7 of row 1 does not exist");
    check_refused(
        scene, [&] { scene.set_motions(motions, 5); }, "the scene has 4 rows");
    check_refused(
        scene, [&] { scene.set_filters(shapes, nullptr, 1); }, "null pointer");
    check_refused(
        scene, [&] { scene.set_margins(numbers, 1, 2); }, "its body was removed");
    check_refused(
        scene, [&] { (void)scene.row_version(4); }, "row 4 does not exist");
    CHECK_NOTHROW(scene.set_positions(static_cast<double*>(nullptr), 0, 4));
}

TEST_CASE("more rows than an index can name are refused with the limit", "[host]") {
    Scene scene = row_of_balls(1);
    try {
        scene.add_bodies(std::size_t{1} << 32, scene.body({0}));
        FAIL("no error");
    } catch (const Error& error) {
        CHECK(error.code() == ErrorCode::LimitExceeded);
        CHECK_THAT(error.what(), Catch::Contains("4294967296") && Catch::Contains("4294967295 is the most"));
    }
    CHECK(scene.row_count() == 1);
}

TEST_CASE("only rows whose numbers differ count as changed", "[host]") {
    Scene scene = row_of_balls(5000);
    std::vector<double> xyz(15000);
    for (std::size_t i = 0; i < 5000; ++i) xyz[3 * i] = static_cast<double>(i);
    std::uint64_t version = scene.version();
    scene.set_positions(xyz.data(), 5000);
    CHECK(scene.version() == version);
    CHECK(changed(scene, version).empty());

    xyz[52] = 1e-300;
    xyz[14999] = -0.0;
    scene.set_positions(xyz.data(), 5000);
    CHECK(scene.version() == version + 1);
    CHECK(changed(scene, version) == std::vector<std::uint32_t>{17, 4999});
    CHECK(scene.row_version(17) == version + 1);
    CHECK(scene.row_version(18) == version);

    version = scene.version();
    const double quiet_nan = std::numeric_limits<double>::quiet_NaN();
    const double q[4] = {quiet_nan, 0, 0, 0};
    scene.set_rotations(q, 1, 30);
    CHECK(changed(scene, version) == std::vector<std::uint32_t>{30});
    version = scene.version();
    scene.set_rotations(q, 1, 30);  // the same NaN again
    CHECK(scene.version() == version);
}

TEST_CASE("changed_rows finds the changes of every version, in any order of making them", "[host]") {
    test::Random random(31);
    Scene scene = row_of_balls(4097);
    struct Change {
        std::uint64_t version;
        std::uint32_t row;
    };
    std::vector<Change> log;
    for (int n = 0; n < 300; ++n) {
        const auto row = static_cast<std::uint32_t>(random.below(4097));
        scene.set_pose({row}, {{random.between(-1, 1), 0, 0}, {}});
        log.push_back({scene.version(), row});
    }
    for (const std::size_t from : {std::size_t{0}, std::size_t{1}, std::size_t{150}, log.size() - 1}) {
        std::vector<std::uint32_t> expected;
        for (std::size_t i = from + 1; i < log.size(); ++i) expected.push_back(log[i].row);
        std::sort(expected.begin(), expected.end());
        expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
        CHECK(changed(scene, log[from].version) == expected);
    }
    CHECK(changed(scene, 0).size() == 4097);
    std::vector<std::uint32_t> appended{1, 2};
    scene.changed_rows(log[log.size() - 2].version, appended);
    CHECK(appended == std::vector<std::uint32_t>{1, 2, log.back().row});
}

TEST_CASE("what a box does not need does not change its row", "[host]") {
    Scene scene = row_of_balls(3);
    const std::uint64_t version = scene.version(), filters = scene.filter_version();
    const double v[3] = {1, 2, 3};
    scene.set_velocities(v, 1);
    scene.set_angular_velocities(v, 1, 1);
    CHECK(scene.version() > version);
    CHECK(scene.filter_version() == filters);
    scene.set_motion({0}, Motion::Static);
    CHECK(scene.filter_version() == scene.version());
    const std::uint64_t moved = scene.version();
    scene.set_filter({2}, 2, 3);
    CHECK(scene.filter_version() > moved);
    CHECK(changed(scene, version).empty());
    const double margin = 0.5;
    scene.set_margins(&margin, 1, 1);
    const std::uint32_t shape = scene.add_shape(Sphere{3}).index;
    scene.set_shapes(&shape, 1, 2);
    CHECK(changed(scene, version) == std::vector<std::uint32_t>{1, 2});
}

TEST_CASE("float arrays set the same numbers as double arrays", "[host]") {
    Scene scene = row_of_balls(2);
    const float xyz[6] = {0.1f, 1e30f, -3.0f, 4.0f, 5.0f, 6.0f};
    const float wxyz[8] = {0.6f, 0.0f, 0.8f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f};
    scene.set_positions(xyz, 2);
    scene.set_rotations(wxyz, 2);
    CHECK(scene.columns().position[0].x == static_cast<double>(0.1f));
    CHECK(scene.columns().position[1].z == 6.0);
    CHECK(scene.columns().rotation[0].y == static_cast<double>(0.8f));
}

TEST_CASE("a replaced shape changes all its bodies and no other", "[host]") {
    Scene scene = row_of_balls(2000);
    const ShapeId box = scene.add_shape(Box{});
    for (const std::uint32_t row : {5u, 6u, 1500u, 1999u}) scene.set_shapes(&box.index, 1, row);
    scene.remove_body({6});
    std::uint64_t version = scene.version();
    scene.set_shape(box, Box{{3, 3, 3}});
    CHECK(changed(scene, version) == std::vector<std::uint32_t>{5, 1500, 1999});
    const std::uint32_t ball = 0;
    scene.set_shapes(&ball, 1, 1500);
    version = scene.version();
    scene.set_shape(box, Plane{});
    CHECK(changed(scene, version) == std::vector<std::uint32_t>{5, 1999});
    CHECK(scene.impl().plane_rows() == std::vector<std::uint32_t>{5, 1999});
    CHECK_FALSE(scene.impl().row_usable(5));
    CHECK(scene.impl().row_usable(1500));
    scene.set_shape(box, Sphere{});
    CHECK(scene.impl().plane_rows().empty());
}

TEST_CASE("bodies of a shape are found again after random adds, moves and removals", "[host]") {
    test::Random random(33);
    Scene scene;
    for (int i = 0; i < 5; ++i) scene.add_shape(Sphere{1.0 + i});
    for (int n = 0; n < 3000; ++n) {
        Body body;
        body.shape = {static_cast<std::uint32_t>(random.below(5))};
        const auto row = static_cast<std::uint32_t>(random.below(scene.row_count() + 1));
        if (random.below(3) == 0 && scene.contains({row}))
            scene.remove_body({row});
        else if (random.below(2) == 0 && scene.contains({row}))
            scene.set_shapes(&body.shape.index, 1, row);
        else
            scene.add_body(body);
        if (n % 100 != 0) continue;
        const auto shape = static_cast<std::uint32_t>(random.below(5));
        const std::uint64_t version = scene.version();
        scene.set_shape({shape}, Sphere{random.between(1, 2)});
        std::vector<std::uint32_t> expected;
        for (std::uint32_t r = 0; r < scene.row_count(); ++r) {
            if (scene.contains({r}) && scene.columns().shape[r] == shape) expected.push_back(r);
        }
        CHECK(changed(scene, version) == expected);
    }
}

TEST_CASE("filters_default counts living rows that are not", "[host]") {
    Scene scene = row_of_balls(3);
    const auto is_default = [&] { return scene.impl().filters_default(); };
    CHECK(is_default());
    scene.set_motion({0}, Motion::Kinematic);
    CHECK(is_default());
    scene.set_motion({0}, Motion::Static);
    CHECK_FALSE(is_default());
    scene.remove_body({0});
    CHECK(is_default());
    scene.set_filter({1}, 2, 0xffffffffu);
    scene.set_filter({2}, 1, 5);
    CHECK_FALSE(is_default());
    scene.set_filter({1}, 1, 0xffffffffu);
    CHECK_FALSE(is_default());
    scene.set_filter({2}, 1, 0xffffffffu);
    CHECK(is_default());
    Body body = scene.body({1});
    body.motion = Motion::Sleeping;
    const BodyId id = scene.add_body(body);
    CHECK_FALSE(is_default());
    scene.set_motion(id, Motion::Dynamic);
    CHECK(is_default());
}

TEST_CASE("copies are scenes of their own, moved scenes stay the same", "[host]") {
    Scene scene = row_of_balls(10);
    scene.set_pose({4}, {{0, 0, 0}, {5, 0, 0, 0}});
    const auto identity = scene.impl().identity;
    Scene copy = scene;
    CHECK(copy.impl().identity != identity);
    CHECK(copy.version() == scene.version());
    CHECK(copy.rejected().size() == 1);
    copy.set_pose({4}, {});
    copy.remove_body({0});
    CHECK(scene.contains({0}));
    CHECK(scene.rejected().size() == 1);
    CHECK(copy.rejected().empty());
    Scene moved = std::move(scene);
    CHECK(moved.impl().identity == identity);
    CHECK(moved.body_count() == 10);
    moved = copy;
    CHECK(moved.impl().identity != copy.impl().identity);
    CHECK(moved.body_count() == 9);
    scene = moved;
    CHECK(scene.body_count() == 9);
}

TEST_CASE("adding many shapes moves them only now and then", "[host]") {
    Scene scene;
    scene.add_shape(Sphere{0.5});
    const Shape* place = &scene.shape({0});
    int moves = 0;
    for (int i = 1; i < 20000; ++i) {
        scene.add_shape(Box{});
        moves += &scene.shape({0}) == place ? 0 : 1;
        place = &scene.shape({0});
    }
    CHECK(moves < 40);
}
