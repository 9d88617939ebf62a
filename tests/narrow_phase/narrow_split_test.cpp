// One call of the narrow phase on several devices: the bytes are those of one.
#include "src/narrow_phase/narrow_split.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "clinch/error.hpp"
#include "clinch/narrow_phase.hpp"
#include "src/narrow_phase/narrow_phase_impl.hpp"
#include "src/narrow_phase/warm_start_impl.hpp"
#include "tests/device/devices.hpp"
#include "tests/narrow_phase/narrow_scenes.hpp"
#include "tests/watchdog.hpp"

using namespace clinch;
using test::same_bytes;
using test::several;
using test::with_precision;

namespace {

constexpr std::size_t small_chunk = 128;

NarrowPhase narrow_of(Context& context, const NarrowPhaseOptions& options, std::size_t chunk,
                      std::vector<double> fractions = {}) {
    NarrowPhase narrow(context, options);
    narrow.impl().devices.chunk_pairs = chunk;
    narrow.impl().devices.fractions = std::move(fractions);
    return narrow;
}

bool same_pairs(const std::vector<Pair>& p, const std::vector<Pair>& q) {
    return p.size() == q.size() && (p.empty() || std::memcmp(p.data(), q.data(), p.size() * sizeof p[0]) == 0);
}

bool same_corners(WarmStart& p, WarmStart& q) {
    const auto &a = p.impl().corners, &b = q.impl().corners;
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0);
}

std::vector<Pair> touching(NarrowPhase& narrow, const Scene& scene, const std::vector<Pair>& pairs) {
    const View<const Pair> view = narrow.touching(scene, pairs);
    CHECK(narrow.report().contacts == view.size());
    return {view.begin(), view.end()};
}

// What the devices did adds up to the call.
void check_report(const NarrowReport& report, const NarrowReport& one, std::size_t chunk) {
    std::uint64_t pairs = 0, chunks = 0;
    for (const DeviceShare& share : report.devices) {
        pairs += share.pairs;
        chunks += share.chunks;
        CHECK(share.stolen <= share.chunks);
        CHECK(share.chunks > 0);
    }
    CHECK(pairs == report.pairs);
    CHECK(chunks == (report.pairs + chunk - 1) / chunk);
    CHECK(report.cells_skipped == one.cells_skipped);
    REQUIRE(report.buckets.size() == one.buckets.size());
    for (std::size_t k = 0; k < one.buckets.size(); ++k) {
        INFO(one.buckets[k].classes);
        CHECK(report.buckets[k].classes == one.buckets[k].classes);
        CHECK(report.buckets[k].numbers == one.buckets[k].numbers);
        CHECK(report.buckets[k].pairs == one.buckets[k].pairs);
        CHECK(report.buckets[k].again == one.buckets[k].again);
    }
}

// One device, and 2, 3 and 4 of them; kept through a test, since each builds its kernels for itself.
struct Crews {
    Context alone = several(0, 1);
    std::vector<Context> crews;
    Crews() {
        for (std::uint32_t devices = 2; devices <= 4; ++devices) crews.push_back(several(0, devices));
    }
};

void check_split(Crews& crews, const NarrowPhaseOptions& options, std::size_t chunk, const Scene& scene,
                 const std::vector<Pair>& pairs) {
    NarrowPhase one = narrow_of(crews.alone, options, chunk);
    const std::vector<Contact> expected = test::found(one, scene, pairs);
    const NarrowReport report = one.report();
    if (report.devices.empty()) {  // all is float64, which only the host has
        CHECK_FALSE(crews.alone.devices()[0].fp64);
        return;
    }
    REQUIRE(report.devices.size() == 1);
    const std::vector<Pair> expected_pairs = touching(one, scene, pairs);
    REQUIRE(expected.size() > 100);
    const std::vector<std::vector<double>> unequal = {{1, 9}, {1, 0.02, 1}, {0, 1, 2, 3}};
    for (std::size_t k = 0; k < crews.crews.size(); ++k)
        for (const auto& fractions : {std::vector<double>(), unequal[k]}) {
            INFO(k + 2 << " devices, " << (fractions.empty() ? "by their speeds" : "unequal"));
            NarrowPhase narrow = narrow_of(crews.crews[k], options, chunk, fractions);
            for (int call = 0; call < 2; ++call) {
                CHECK(same_bytes(test::found(narrow, scene, pairs), expected));
                check_report(narrow.report(), report, chunk);
            }
            CHECK(same_pairs(touching(narrow, scene, pairs), expected_pairs));
        }
}

}  // namespace

TEST_CASE("contacts of several devices are those of one, to the byte", "[device][builds]") {
    Crews crews;
    std::uint64_t seed = 120;
    for (const auto& [precision, points] :
         std::vector<std::pair<double, std::uint32_t>>{{0.0, 1}, {0.5, 1}, {1.0, 1}, {0.0, 8}, {0.5, 4}, {1.0, 4}}) {
        test::Random random(++seed);
        INFO("seed " << seed << ", precision " << precision << ", points " << points);
        Scene scene = test::random_bodies(60, 2.2, {3, -4, 5}, random);
        if (seed % 2 == 0) {
            const std::vector<double> margins(scene.row_count(), 0.05);
            scene.set_margins(margins.data(), margins.size());
        }
        NarrowPhaseOptions options = with_precision(precision);
        options.contacts_per_pair = points;
        check_split(crews, options, small_chunk, scene, test::all_pairs(scene));
    }
}

TEST_CASE("a tolerance is kept by several devices as by one", "[device][builds]") {
    Crews crews;
    test::Random random(131);
    INFO("seed 131");
    const Scene scene = test::random_bodies(60, 2.0, {0, 0, 0}, random);
    for (const double tolerance : {1e-4, 1e-9}) {
        NarrowPhaseOptions options;
        options.tolerance = tolerance;
        check_split(crews, options, small_chunk, scene, test::all_pairs(scene));
    }
}

TEST_CASE("what float32 leaves open is decided by each device for itself", "[device][builds]") {
    // More in a chunk than the host would take over, all of them in touch to the last digit.
    Scene scene;
    const ShapeId ball = scene.add_shape(Sphere{0.5});
    std::vector<Pair> pairs;
    for (std::uint32_t i = 0; i < 6000; ++i) {
        Body body;
        body.shape = ball;
        body.pose.position = {0.3 * i, 0, 0};
        const BodyId a = scene.add_body(body);
        body.pose.position.y = i % 5 == 0 ? 1.5 : 1.0;
        pairs.push_back({a.index, scene.add_body(body).index});
    }
    Crews crews;
    check_split(crews, with_precision(0.5), 1500, scene, pairs);
}

TEST_CASE("corners that pairs start from are the same on several devices", "[device][builds]") {
    for (const double precision : {0.0, 1.0}) {
        test::Random random(132);
        INFO("seed 132, precision " << precision);
        Scene scene = test::random_bodies(60, 2.0, {0, 0, 0}, random);
        const std::vector<Pair> pairs = test::all_pairs(scene);
        Context alone = several(0, 1), context = several(0, 3);
        NarrowPhase one = narrow_of(alone, with_precision(precision), small_chunk);
        NarrowPhase split = narrow_of(context, with_precision(precision), small_chunk);
        WarmStart warm_one, warm_split;
        for (int frame = 0; frame < 5; ++frame) {
            INFO("frame " << frame);
            const std::vector<Contact> expected = test::found(one, scene, pairs, &warm_one);
            CHECK(same_bytes(test::found(split, scene, pairs, &warm_split), expected));
            CHECK(split.report().warm == one.report().warm);
            CHECK(same_corners(warm_split, warm_one));
            for (std::uint32_t i = 0; i < scene.row_count(); i += 1 + static_cast<std::uint32_t>(frame)) {
                Pose pose = scene.body({i}).pose;
                pose.position.x += random.between(-0.02, 0.02);
                pose.position.z += random.between(-0.02, 0.02);
                scene.set_pose({i}, pose);
            }
            if (frame == 2) scene.set_shape({5}, Box{{0.4, 0.3, 0.2}});
        }
    }
}

TEST_CASE("parts of one device share a call", "[device]") {
    for (const DeviceInfo& info : list_devices()) {
        if (info.platform.find("Portable") == std::string::npos || info.compute_units < 2)
            continue;  // no partition elsewhere
        test::Random random(133);
        INFO("seed 133, device " << info.index);
        const Scene scene = test::random_bodies(60, 2.0, {0, 0, 0}, random);
        const std::vector<Pair> pairs = test::all_pairs(scene);
        ContextOptions options;
        options.devices.indices = {info.index};
        Context alone(options);
        options.devices.sub_devices = 2;
        Context parts(options);
        REQUIRE(parts.devices().size() == 2);
        NarrowPhase one = narrow_of(alone, with_precision(0.0), small_chunk);
        NarrowPhase split = narrow_of(parts, with_precision(0.0), small_chunk);
        const std::vector<Contact> expected = test::found(one, scene, pairs);
        CHECK(same_bytes(test::found(split, scene, pairs), expected));
        CHECK(parts.report()[1].opened);
    }
}

TEST_CASE("a device that a call is too small for is not opened", "[device]") {
    test::Random random(134);
    INFO("seed 134");
    const Scene scene = test::random_bodies(40, 2.0, {0, 0, 0}, random);
    std::vector<Pair> pairs = test::all_pairs(scene);
    pairs.resize(5 * small_chunk);
    Context context = several(0, 3);
    NarrowPhase narrow = narrow_of(context, with_precision(0.0), small_chunk);
    const auto opened = [&] {
        const std::vector<DeviceReport> reports = context.report();
        return std::count_if(reports.begin(), reports.end(), [](const DeviceReport& r) { return r.opened; });
    };
    narrow.find(scene, {pairs.data(), 3 * small_chunk});
    CHECK(opened() == 1);
    CHECK(narrow.report().devices.size() == 1);
    narrow.find(scene, pairs);
    CHECK(opened() == 2);
    // A device of another kind has no part in it.
    Context unlike = several(0, 2);
    unlike.impl().infos[1].driver_version += " of another kind";
    NarrowPhase other = narrow_of(unlike, with_precision(0.0), small_chunk);
    other.find(scene, pairs);
    CHECK(other.report().devices.size() == 1);
    CHECK_FALSE(unlike.report()[1].opened);
}

namespace {

// As chunks that become known out of order would be written, by one thread so that it is the same each time: one of two
// members has one chunk in each `stride`, and does all of its chunks, backwards, before the other begins.
void check_out_of_order(bool only_pairs, std::uint32_t points, std::uint32_t stride) {
    INFO("only pairs: " << only_pairs << ", points " << points << ", stride " << stride);
    test::Random random(135);
    const Scene scene = test::random_bodies(50, 2.0, {0, 0, 0}, random);
    const std::vector<Pair> pairs = test::all_pairs(scene);
    const auto chunks = static_cast<std::uint32_t>((pairs.size() + small_chunk - 1) / small_chunk);
    Context context = several(0, 2);
    NarrowPhaseOptions options = with_precision(0.0);
    options.contacts_per_pair = points;
    detail::NarrowSettings settings(options);
    settings.shapes.update(scene);
    const detail::NarrowCall call{scene, pairs, only_pairs, nullptr};
    detail::NarrowMember first(context.impl().open(0), settings), second(context.impl().open(1), settings);
    detail::NarrowResult result;
    detail::ContactPlaces places(chunks);
    const auto work = [&](detail::NarrowMember& member, std::uint32_t chunk) {
        const std::size_t begin = chunk * small_chunk;
        member.do_chunk(call, chunk, begin, std::min(small_chunk, pairs.size() - begin), places, result);
    };
    for (std::uint32_t c = chunks; c-- > 0;)
        if (c % stride == stride - 1) work(first, c);
    for (std::uint32_t c = 0; c < chunks; ++c)
        if (c % stride != stride - 1) work(second, c);
    first.settle(call, places, result);
    second.settle(call, places, result);
    result.resize(only_pairs, places.told());
    first.copy_set_aside(call, places, result);
    second.copy_set_aside(call, places, result);

    Context alone = several(0, 1);
    NarrowPhase one = narrow_of(alone, options, small_chunk);
    if (only_pairs) {
        const View<const Pair> found = result.touching.view();
        CHECK(same_pairs({found.begin(), found.end()}, touching(one, scene, pairs)));
    } else {
        const View<const Contact> found = result.contacts.view();
        CHECK(same_bytes({found.begin(), found.end()}, test::found(one, scene, pairs)));
    }
}

}  // namespace

TEST_CASE("chunks that are done out of order come into order", "[device][builds]") {
    INFO("seed 135");
    for (const std::uint32_t stride : {2u, 3u}) {
        check_out_of_order(false, 1, stride);
        check_out_of_order(false, 4, stride);
        check_out_of_order(true, 1, stride);
    }
}

TEST_CASE("of several wrong pairs the first is named, whatever the devices", "[device]") {
    Scene scene;
    Body body;
    body.shape = scene.add_shape(Sphere{});
    for (int i = 0; i < 40; ++i) scene.add_body(body);
    std::vector<Pair> pairs = test::all_pairs(scene);
    pairs[400] = {3, 1000};
    pairs[450] = {4, 1000};
    pairs[700] = {5, 1000};
    Context context = several(0, 4);
    NarrowPhase narrow = narrow_of(context, with_precision(0.0), 32);
    WarmStart warm;
    for (int call = 0; call < 4; ++call) {
        std::string what;
        try {
            narrow.find(scene, pairs, &warm);
        } catch (const Error& error) {
            CHECK(error.code() == ErrorCode::InvalidArgument);
            what = error.what();
        }
        INFO(what);
        CHECK(what.find("the pair 3, 1000") != std::string::npos);
    }
    for (const std::size_t wrong : {400u, 450u, 700u}) pairs[wrong] = {0, 1};
    CHECK(narrow.find(scene, pairs, &warm).size() == pairs.size());
}

namespace {

// Chunks of spheres only and then of hulls, whose manifolds need more memory than the other buffers: a device that has
// less fails in the middle of a chunk, when its corners have been written already.
struct ShortOfMemory {
    static constexpr std::size_t most = 80000;  // bytes of a buffer
    Scene scene;
    std::vector<Pair> pairs;
    NarrowPhaseOptions options = with_precision(0.0);

    ShortOfMemory() {
        test::Random random(136);
        Body body;
        for (int i = 0; i < 60; ++i) {
            body.shape = scene.add_shape(test::random_shape(i < 30 ? 0 : 6, random));
            body.pose.position = {random.between(0, 1), random.between(0, 1), random.between(0, 1)};
            scene.add_body(body);
        }
        pairs = test::all_pairs(scene);
        std::stable_partition(pairs.begin(), pairs.end(), [](const Pair& pair) { return pair.b < 30; });
        options.contacts_per_pair = 8;
    }
};

}  // namespace

TEST_CASE("what a device that fails has left is done by the others", "[device][builds]") {
    const test::Watchdog watchdog;
    INFO("seed 136");
    const ShortOfMemory input;
    Context alone = several(0, 1);
    NarrowPhase one = narrow_of(alone, input.options, small_chunk);
    for (const std::size_t sound : {0u, 1u, 2u}) {
        INFO("sound: device " << sound);
        Context context = several(0, 3);
        for (std::size_t i = 0; i < 3; ++i)
            if (i != sound) context.impl().infos[i].max_allocation = ShortOfMemory::most;
        NarrowPhase split = narrow_of(context, input.options, small_chunk);
        WarmStart warm_one, warm_split;
        for (int call = 0; call < 3; ++call) {
            const std::vector<Contact> expected = test::found(one, input.scene, input.pairs, &warm_one);
            CHECK(same_bytes(test::found(split, input.scene, input.pairs, &warm_split), expected));
            CHECK(same_corners(warm_split, warm_one));
            const NarrowReport& report = split.report();
            check_report(report, one.report(), small_chunk);
            CHECK(context.impl().in_use(sound));
            for (const std::string& line : report.warnings) CHECK(line.find("failed") != std::string::npos);
        }
    }
}

TEST_CASE("a call of one device that fails is done again on the next, until none is left", "[device][builds]") {
    const test::Watchdog watchdog;
    INFO("seed 136");
    const ShortOfMemory input;
    Context alone = several(0, 1);
    NarrowPhase one = narrow_of(alone, input.options, detail::Slots::chunk_pairs);
    for (const bool open : {false, true}) {
        INFO("a sound device: " << open);
        Context context = several(0, 3);
        for (std::size_t i = 0; i < (open ? 2u : 3u); ++i) context.impl().infos[i].max_allocation = ShortOfMemory::most;
        NarrowPhase narrow(context, input.options);
        WarmStart warm_one, warm;
        if (!open) {
            CHECK_THROWS_AS(narrow.find(input.scene, input.pairs, &warm), Error);
            CHECK(context.impl().crew() == std::vector<std::size_t>{2});
            CHECK(warm.size() == 0);
            continue;
        }
        const std::vector<Contact> expected = test::found(one, input.scene, input.pairs, &warm_one);
        CHECK(same_bytes(test::found(narrow, input.scene, input.pairs, &warm), expected));
        CHECK(same_corners(warm, warm_one));
        CHECK(narrow.report().warnings.size() == 2);
        REQUIRE(narrow.report().devices.size() == 1);
        CHECK(narrow.report().devices[0].device == 2);
        CHECK(same_bytes(test::found(narrow, input.scene, input.pairs), expected));
        CHECK(narrow.report().warnings.empty());
    }
}
