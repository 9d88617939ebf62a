// Failures in the calls of a broad phase beside find(): stream(), count() and update(), on one device and on two.
#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <utility>
#include <vector>

#include "bench/scenes/boxes.hpp"
#include "clinch/broad_phase.hpp"
#include "src/broad_phase/broad_phase_impl.hpp"
#include "tests/device/crew_faults.hpp"
#include "tests/device/devices.hpp"

using namespace clinch;
using test::Failing;
using test::Faults;
using test::Trial;

namespace {

constexpr std::uint64_t seed = 43;

// Of the algorithms, those that differ in how they put pairs out.
std::vector<std::string> algorithms(const DeviceInfo& device) {
    std::vector<std::string> names;
    for (const char* const name : {"brute", "grid", "bvh", "sweep"})
        if (detail::runs_on(detail::algorithm_named(name), device)) names.push_back(name);
    return names;
}

BroadPhaseOptions with_pieces(const std::string& algorithm) {
    BroadPhaseOptions options;
    options.algorithm = algorithm;
    options.stream_bytes = 200 * sizeof(Pair);
    return options;
}

// All pairs handed over, and how many there are said to be.
std::string streamed(BroadPhase& broad, const std::vector<Aabb>& boxes) {
    std::vector<Pair> all;
    std::size_t pieces = 0;
    const std::uint64_t count = broad.stream(boxes, [&](View<const Pair> pairs) {
        all.insert(all.end(), pairs.begin(), pairs.end());
        ++pieces;
    });
    CHECK(pieces > 3);
    std::sort(all.begin(), all.end());
    return test::bytes(View<const Pair>(all)) + std::to_string(count);
}
std::string counted(BroadPhase& broad, const std::vector<Aabb>& boxes) {
    return std::to_string(broad.count(boxes));
}

std::string events(const BroadPhase& broad) {
    return test::bytes(broad.added()) + "," + test::bytes(broad.removed());
}
// The list before was lost, and it is said.
bool lost_events(const BroadPhase& broad) {
    const std::vector<std::string>& lines = broad.report().warnings;
    return std::find(lines.begin(), lines.end(), BroadPhase::Impl::events_lost) != lines.end();
}

// Boxes that change a little twice, the list of the first change being kept on the device.
struct Changes {
    std::vector<Aabb> before = scenes::make_boxes("density", 10000, seed), first = before, second = before;
    std::vector<std::uint32_t> changed;
    Changes() {
        for (std::uint32_t i = 3; i < before.size(); i += 40) {
            changed.push_back(i);
            first[i].max[0] += 0.5f;
            second[i].min[1] -= 1.5f;
        }
    }
};

}  // namespace

TEST_CASE("streams and counts of pairs bear the failure of any OpenCL call", "[device]") {
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", 3000, seed);
    Context context(test::first_device());
    Faults faults(context);
    for (const std::string& name : algorithms(context.devices()[0])) {
        INFO(name);
        const auto fresh = [&] { return BroadPhase(context, with_pieces(name)); };
        const auto stream = [&](BroadPhase& broad) { return streamed(broad, boxes); };
        const auto count = [&](BroadPhase& broad) { return counted(broad, boxes); };
        const auto answer_of = [&](const auto& ask) {
            BroadPhase broad = fresh();
            return ask(broad);
        };
        const std::size_t most = test::faults_of_a_name(context, 6);
        test::check_faults(context, faults, Trial{fresh, stream, answer_of(stream), most, seed});
        test::check_faults(context, faults, Trial{fresh, count, answer_of(count), most, seed});
    }
}

TEST_CASE("streams and counts of pairs bear the failure of one of two devices, and of both", "[device]") {
    const std::vector<Aabb> boxes = scenes::make_boxes("uniform", 3000, seed);
    Failing failing(2);
    for (const std::string& name : algorithms(failing.context.devices()[0])) {
        INFO(name);
        const auto fresh = [&] { return BroadPhase(failing.context, with_pieces(name)); };
        const auto stream = [&](BroadPhase& broad) { return streamed(broad, boxes); };
        const auto count = [&](BroadPhase& broad) { return counted(broad, boxes); };
        const auto answer_of = [&](const auto& ask) {
            BroadPhase broad = fresh();
            return ask(broad);
        };
        const std::size_t most = test::faults_of_a_name(failing.context, 8);
        // Pairs that were handed over cannot be taken back: then another device cannot begin again.
        test::check_crew_faults(failing, Trial{fresh, stream, answer_of(stream), most, seed}, true);
        test::check_crew_faults(failing, Trial{fresh, count, answer_of(count), most, seed});
    }
}

TEST_CASE("updates of a broad phase bear the failure of one of two devices, and of both", "[device]") {
    Failing failing(2);
    if (!detail::runs_on(detail::algorithm_named("grid"), failing.context.devices()[0])) return;
    const Changes changes;
    BroadPhaseOptions options;
    options.algorithm = "grid";
    options.events = true;
    const auto fresh = [&] { return BroadPhase(failing.context, options); };
    const auto found = [&] {
        BroadPhase broad = fresh();
        broad.find(changes.before);
        return broad;
    };
    const auto updated = [&] {
        BroadPhase broad = found();
        broad.update(changes.first, changes.changed);
        return broad;
    };
    const auto twice = [&] {  // the list before is on the device alone
        BroadPhase broad = updated();
        broad.update(changes.second, changes.changed);
        CHECK(broad.report().algorithm == "incremental");
        return broad;
    };
    // What full searches tell.
    const auto searched = [&](const std::vector<Aabb>& before, const std::vector<Aabb>& after) {
        BroadPhase broad = fresh();
        broad.find(before);
        const std::string pairs = test::bytes(broad.find(after));
        CHECK(broad.added().size() + broad.removed().size() > 20);
        return std::make_pair(pairs, events(broad));
    };
    const auto check = [&](const auto& make, const std::vector<Aabb>& before, const std::vector<Aabb>& after) {
        const auto [pairs, changed] = searched(before, after);
        const std::string expected = changed;
        const auto ask = [&](BroadPhase& broad) {
            const std::string list = test::bytes(broad.update(after, changes.changed));
            if (!lost_events(broad)) return list + events(broad);
            CHECK(test::bytes(broad.added()) == list);
            return list + expected;
        };
        test::check_crew_faults(failing, Trial{make, ask, pairs + expected, 12, seed});
    };
    check(found, changes.before, changes.first);
    check(updated, changes.first, changes.second);
    check(twice, changes.second, changes.first);
}
