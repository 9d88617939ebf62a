#include "clinch/narrow_phase.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "clinch/error.hpp"
#include "src/narrow_phase/narrow_phase_impl.hpp"
#include "tests/device/devices.hpp"
#include "tests/narrow_phase/narrow_scenes.hpp"

using namespace clinch;
using test::found;
using test::same_bytes;
using test::with_precision;

namespace {

double length(const Vec3& v) {
    return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

// What holds of every contact whatever its shapes.
void check_sound(const Contact& c) {
    INFO("pair " << c.a << ", " << c.b << ", distance " << c.distance << ", error " << c.error);
    CHECK(c.a < c.b);
    CHECK(std::isfinite(c.distance));
    CHECK(std::isfinite(c.error));
    CHECK(c.error >= 0.0);
    CHECK(std::abs(length(c.normal) - 1.0) < 1e-6);
    CHECK(c.on_b.x == c.on_a.x + c.distance * c.normal.x);
}

// Answers in float32, with what they promise, against those in float64 of the host.
void check_against_exact(Context& context, double precision, const Scene& scene, const std::vector<Pair>& pairs) {
    Context host = Context::host_only();
    const auto exact = test::by_pair(found(host, with_precision(1.0), scene, pairs));
    const auto fast = test::by_pair(found(context, with_precision(precision), scene, pairs));
    for (const auto& [pair, c] : fast) {
        check_sound(c);
        INFO("pair " << pair.first << ", " << pair.second << ", precision " << precision);
        const auto e = exact.find(pair);
        if (e == exact.end()) {  // apart, but within what float32 can tell
            CHECK(c.distance <= c.error);
            CHECK(precision < 0.25);
            continue;
        }
        CHECK(std::abs(c.distance - e->second.distance) <= c.error + e->second.error);
    }
    for (const auto& [pair, e] : exact) {  // none is missed
        INFO("pair " << pair.first << ", " << pair.second << ", distance " << e.distance << " within " << e.error);
        CHECK((fast.count(pair) == 1 || e.distance > 0.0));
    }
}

}  // namespace

TEST_CASE("float64 answers of a device are those of the host, to what two floats hold", "[device][builds]") {
    test::Random random(71);
    INFO("seed 71");
    const Scene scene = test::random_bodies(60, 2.0, {0, 0, 0}, random);
    const std::vector<Pair> pairs = test::all_pairs(scene);
    Context host = Context::host_only();
    const std::vector<Contact> expected = found(host, with_precision(1.0), scene, pairs);
    REQUIRE(expected.size() > 300);
    for (const Contact& c : expected) check_sound(c);
    for (std::uint32_t i = 0; i < list_devices().size(); ++i)
        for (const std::uint32_t lanes : {list_devices()[i].lanes}) {
            Context context = test::with_lanes(i, lanes);
            INFO("device " << i << ", lanes " << lanes);
            const std::vector<Contact> answers = found(context, with_precision(1.0), scene, pairs);
            CHECK(answers.size() == expected.size());
            // On a device they pass through two floats.
            const auto by_pair = test::by_pair(expected);
            for (const Contact& c : answers) {
                const auto e = by_pair.find({c.a, c.b});
                REQUIRE(e != by_pair.end());
                INFO("pair " << c.a << ", " << c.b);
                CHECK(std::abs(c.distance - e->second.distance) <= 0x1p-46 * (1.0 + std::abs(c.distance)));
            }
        }
}

TEST_CASE("float32 answers keep their promise, and what they leave open float64 decides", "[device][builds]") {
    for (const std::uint64_t seed : {72u, 73u}) {
        test::Random random(seed);
        INFO("seed " << seed);
        const Scene scene = test::random_bodies(70, 2.5, seed == 73 ? Vec3{1e5, -1e5, 1e5} : Vec3{}, random);
        const std::vector<Pair> pairs = test::all_pairs(scene);
        for (std::uint32_t i = 0; i < list_devices().size(); ++i)
            for (const std::uint32_t lanes : std::set<std::uint32_t>{1u, list_devices()[i].lanes}) {
                Context context = test::with_lanes(i, lanes);
                INFO("device " << i << ", lanes " << lanes);
                check_against_exact(context, 0.0, scene, pairs);
                check_against_exact(context, 0.5, scene, pairs);
                // Of a GPU its own float64 decides, not the host's.
                Context as_gpu = test::with_lanes(i, lanes);
                as_gpu.impl().infos[0].type = DeviceType::Gpu;
                check_against_exact(as_gpu, 0.5, scene, pairs);
            }
    }
}

namespace {

// touching() against the distances of float64.
void check_touching(Context& context, double precision, const Scene& scene, const std::vector<Pair>& pairs) {
    Context host = Context::host_only();
    const auto exact = test::by_pair(found(host, with_precision(1.0), scene, pairs));
    NarrowPhase narrow(context, with_precision(precision));
    const View<const Pair> view = narrow.touching(scene, pairs);
    CHECK(narrow.report().contacts == view.size());
    std::set<std::pair<std::uint32_t, std::uint32_t>> touching;
    for (const Pair& pair : view) touching.insert({pair.a, pair.b});
    CHECK(touching.size() == view.size());
    const auto before = [](const Pair& p, const Pair& q) { return std::tie(p.a, p.b) < std::tie(q.a, q.b); };
    CHECK(std::is_sorted(view.begin(), view.end(), before));
    std::size_t sure = 0;
    for (const Pair& pair : pairs) {
        INFO("pair " << pair.a << ", " << pair.b << ", precision " << precision);
        const double margins = scene.columns().margin[pair.a] + scene.columns().margin[pair.b];
        const auto e = exact.find({pair.a, pair.b});
        if (e == exact.end()) {
            CHECK((precision < 0.25 || touching.count({pair.a, pair.b}) == 0));
        } else if (e->second.distance + e->second.error < margins) {
            ++sure;
            CHECK(touching.count({pair.a, pair.b}) == 1);
        }
    }
    CHECK(sure > 100);
    CHECK(touching.size() < sure + sure / 10 + 10);
}

}  // namespace

TEST_CASE("which pairs touch is told without contacts", "[device][builds]") {
    for (const double margin : {0.0, 0.05}) {
        test::Random random(78);
        INFO("seed 78, margin " << margin);
        Scene scene = test::random_bodies(60, 2.5, {0, 0, 0}, random);
        const std::vector<double> margins(scene.row_count(), margin);
        scene.set_margins(margins.data(), margins.size());
        const std::vector<Pair> pairs = test::all_pairs(scene);
        Context host = Context::host_only();
        check_touching(host, 1.0, scene, pairs);
        for (std::uint32_t i = 0; i < list_devices().size(); ++i)
            for (const double precision : {0.0, 0.5, 1.0}) {
                Context context = test::with_lanes(i, list_devices()[i].lanes);
                INFO("device " << i);
                check_touching(context, precision, scene, pairs);
            }
    }
}

namespace {

// Few bodies of every class, for the simulator that looks at every access.
void check_few(std::uint32_t lanes) {
    test::Random random(77);
    INFO("seed 77, lanes " << lanes);
    const Scene scene = test::random_bodies(18, 1.2, {0, 0, 0}, random);
    const std::vector<Pair> pairs = test::all_pairs(scene);
    REQUIRE(pairs.size() >= 128);  // on a device
    for (std::uint32_t i = 0; i < list_devices().size(); ++i) {
        Context context = test::with_lanes(i, lanes);
        check_against_exact(context, 0.5, scene, pairs);
    }
}

}  // namespace

TEST_CASE("a narrow phase of few bodies", "[device][plain]") {
    check_few(1);
}

TEST_CASE("a narrow phase of few bodies in lanes", "[device][plain]") {
    check_few(8);
}

TEST_CASE("few pairs are grouped alike by the host and by a device", "[device][plain]") {
    test::Random random(79);
    INFO("seed 79");
    const Scene scene = test::random_bodies(18, 1.2, {0, 0, 0}, random);
    const std::vector<Pair> all = test::all_pairs(scene);
    // Of several classes, and of one.
    const std::vector<Pair> alike(200, all.front());
    for (std::uint32_t i = 0; i < list_devices().size(); ++i)
        for (const std::vector<Pair>& pairs : {all, alike}) {
            Context context = test::with_lanes(i, 1);
            NarrowPhase by_host(context), by_device(context);
            by_device.impl().settings.grouped_on_host = 0;
            const std::vector<Contact> contacts = found(by_host, scene, pairs);
            CHECK(same_bytes(contacts, found(by_device, scene, pairs)));
            if (pairs.size() == all.size()) CHECK(contacts.size() > 20);
        }
}

TEST_CASE("a narrow phase keeps up with a scene that changes", "[device]") {
    test::Random random(74);
    INFO("seed 74");
    Context context;
    Scene scene = test::random_bodies(50, 2.0, {0, 0, 0}, random);
    NarrowPhase kept(context);
    for (int step = 0; step < 8; ++step) {
        const std::vector<Pair> pairs = test::all_pairs(scene);
        // So few need no device, which must hear of what changed all the same.
        kept.find(scene, {pairs.data(), 2});
        const View<const Contact> contacts = kept.find(scene, pairs);
        CHECK(same_bytes({contacts.begin(), contacts.end()}, found(context, {}, scene, pairs)));
        const BodyId moved{static_cast<std::uint32_t>(random.below(scene.row_count()))};
        if (step == 0) scene.set_pose(moved, {{1, 1, 1}, test::random_rotation(random)});
        if (step == 1) scene.set_shape({0}, Sphere{0.9});
        if (step == 2) {
            Body body;
            body.shape = scene.add_shape(Cone{0.4, 0.3});
            body.pose.position = {1, 1, 1};
            for (int i = 0; i < 30; ++i) scene.add_body(body);
        }
        if (step == 3) {
            const std::vector<double> margins(scene.row_count(), 0.1);
            scene.set_margins(margins.data(), margins.size());
        }
        if (step == 4) {
            const std::vector<double> none(scene.row_count(), 0.0);
            scene.set_margins(none.data(), none.size());
        }
        if (step == 5)  // most of them
            for (std::uint32_t i = 0; i + 5 < scene.row_count(); ++i)
                scene.set_pose({i}, {scene.body({i}).pose.position, test::random_rotation(random)});
        if (step == 6) scene = test::random_bodies(40, 1.5, {0, 0, 0}, random);
    }
}

TEST_CASE("spheres in more than one chunk", "[device]") {
    test::Random random(75);
    INFO("seed 75");
    Scene scene;
    const ShapeId ball = scene.add_shape(Sphere{0.25});
    for (int i = 0; i < 800; ++i) {
        Body body;
        body.shape = ball;
        body.pose.position = {random.between(0, 2), random.between(0, 2), random.between(0, 2)};
        scene.add_body(body);
    }
    const std::vector<Pair> pairs = test::all_pairs(scene);
    REQUIRE(pairs.size() > 300000);
    Context context;
    const std::vector<Contact> contacts = found(context, {}, scene, pairs);
    auto next = contacts.begin();
    for (const Pair& pair : pairs) {
        const Vec3 p = scene.body({pair.a}).pose.position, q = scene.body({pair.b}).pose.position;
        const double distance = length({q.x - p.x, q.y - p.y, q.z - p.z}) - 0.5;
        if (distance > 0.0) continue;
        REQUIRE(next != contacts.end());
        INFO("pair " << pair.a << ", " << pair.b);
        CHECK((next->a == pair.a && next->b == pair.b));
        CHECK(std::abs(next->distance - distance) <= next->error);
        ++next;
    }
    CHECK(next == contacts.end());
}

TEST_CASE("gaps within the margins are told", "[device]") {
    Scene scene;
    const ShapeId ball = scene.add_shape(Sphere{0.5}), box = scene.add_shape(Box{{0.5, 0.5, 0.5}});
    std::vector<Pair> pairs;
    for (std::uint32_t i = 0; i < 400; ++i) {  // gaps of 0, 0.001, 0.002 ...
        Body body;
        body.margin = 0.05;
        body.shape = ball;
        body.pose.position = {10.0 * i, 0, 0};
        const BodyId a = scene.add_body(body);
        body.shape = box;
        body.margin = 0.07;
        body.pose.position.x += 1.0 + 0.001 * i;
        pairs.push_back({a.index, scene.add_body(body).index});
    }
    Context context;
    const std::vector<Contact> contacts = found(context, {}, scene, pairs);
    CHECK(contacts.size() >= 120);
    CHECK(contacts.size() <= 121);  // at 0.12 it is a matter of rounding
    for (const Contact& c : contacts) {
        const double gap = (scene.body({c.b}).pose.position.x - scene.body({c.a}).pose.position.x) - 1.0;
        CHECK(std::abs(c.distance - gap) <= c.error);
    }
}

TEST_CASE("a tolerance is met or its missing is told", "[device]") {
    test::Random random(76);
    INFO("seed 76");
    const Scene scene = test::random_bodies(60, 2.0, {0, 0, 0}, random);
    const std::vector<Pair> pairs = test::all_pairs(scene);
    Context context;
    for (const double tolerance : {1e-3, 1e-8, 1e-30}) {
        NarrowPhaseOptions options;
        options.tolerance = tolerance;
        NarrowPhase narrow(context, options);
        std::uint64_t missed = 0;
        for (const Contact& c : narrow.find(scene, pairs)) missed += c.error > tolerance ? 1 : 0;
        INFO("tolerance " << tolerance);
        CHECK(narrow.report().tolerance_missed == missed);
        if (tolerance >= 1e-8) CHECK(missed == 0);
        if (tolerance < 1e-20) CHECK(missed > 0);
    }
}

TEST_CASE("what the narrow phase cannot take is named", "[device]") {
    Context context;
    const auto error_of = [&](const Scene& scene, std::vector<Pair> pairs, std::size_t times) {
        std::vector<Pair> many;
        for (std::size_t i = 0; i < times; ++i) many.insert(many.end(), pairs.begin(), pairs.end());
        NarrowPhase narrow(context);
        try {
            narrow.find(scene, many);
        } catch (const Error& e) {
            CHECK(e.code() == ErrorCode::InvalidArgument);
            return std::string(e.what());
        }
        return std::string();
    };
    Scene scene;
    Body body;
    body.shape = scene.add_shape(Sphere{});
    scene.add_body(body);
    scene.add_body(body);
    body.shape = scene.add_shape(Plane{});
    scene.add_body(body);
    scene.add_body(body);
    body.shape = scene.add_shape(Mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
    scene.add_body(body);
    body.shape = scene.add_shape(Sphere{-1.0});
    scene.add_body(body);
    for (const std::size_t times : {1u, 1000u, 10000u}) {  // on the host, on a device, grouped by it, too
        CHECK(error_of(scene, {{0, 1}, {0, 2}}, times).empty());
        for (const Pair& pair : {Pair{1, 0}, Pair{1, 1}, Pair{2, 3}, Pair{0, 4}, Pair{1, 5}, Pair{0, 6}}) {
            const std::string what = error_of(scene, {{0, 1}, pair}, times);
            INFO(what);
            CHECK(what.find("the pair " + std::to_string(pair.a) + ", " + std::to_string(pair.b)) != std::string::npos);
        }
    }
    CHECK_THROWS_AS(NarrowPhase(context, with_precision(1.5)), Error);
    CHECK_THROWS_AS(NarrowPhase(context, with_precision(std::nan(""))), Error);
    NarrowPhaseOptions options;
    options.tolerance = 0.0;
    CHECK_THROWS_AS(NarrowPhase(context, options), Error);
    CHECK(NarrowPhase(context).find(scene, {}).empty());
}
