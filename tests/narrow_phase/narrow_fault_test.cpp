// Failures in the less common calls of a narrow phase: touching(), warm starts of the caller's, float64.
#include <catch2/catch.hpp>
#include <string>
#include <utility>
#include <vector>

#include "clinch/narrow_phase.hpp"
#include "src/narrow_phase/narrow_phase_impl.hpp"
#include "tests/device/crew_faults.hpp"
#include "tests/device/devices.hpp"
#include "tests/narrow_phase/narrow_scenes.hpp"

using namespace clinch;
using test::Failing;
using test::Faults;
using test::few_classes;
using test::Trial;

namespace {

constexpr std::uint64_t seed = 41;

// One way to call a narrow phase.
struct Way {
    const char* name;
    double precision;
    bool touching, warm;
};
constexpr Way ways[] = {{"which pairs touch", 0.5, true, false},
                        {"contacts from a warm start", 0.0, false, true},
                        {"which pairs touch, from a warm start", 0.5, true, true},
                        {"contacts in float64", 1.0, false, false},
                        {"which pairs touch, in float64, from a warm start", 1.0, true, true}};

// A narrow phase with what its caller keeps.
struct Called {
    NarrowPhase narrow;
    WarmStart warm;
};

struct Work {
    Scene before = few_classes(70, seed), scene = before;
    std::vector<Pair> pairs = test::all_pairs(before);
    Work() { test::move_some(scene, seed); }

    std::string ask(Called& called, const Way& way, const Scene& of) const {
        WarmStart* const warm = way.warm ? &called.warm : nullptr;
        if (way.touching) return test::bytes(called.narrow.touching(of, pairs, warm));
        return test::bytes(called.narrow.find(of, pairs, warm));
    }
};

Called fresh(Context& context, const Way& way, std::size_t chunk_pairs = detail::Slots::chunk_pairs) {
    Called called{NarrowPhase(context, test::with_precision(way.precision)), WarmStart()};
    called.narrow.impl().devices.chunk_pairs = chunk_pairs;
    return called;
}

// It has float64, or has no need of it.
bool runs(const DeviceInfo& device, const Way& way) {
    return way.precision < 1.0 || device.fp64;
}

}  // namespace

TEST_CASE("all calls of a narrow phase bear the failure of any OpenCL call", "[device]") {
    const Work work;
    Context context(test::first_device());
    Faults faults(context);
    for (const Way& way : ways) {
        if (!runs(context.devices()[0], way)) continue;
        INFO(way.name);
        const auto make = [&] { return fresh(context, way); };
        // What was sent for the scene before is there, and the corners of its pairs are.
        const auto used = [&] {
            Called called = make();
            work.ask(called, way, work.before);
            return called;
        };
        const auto ask = [&](Called& called) { return work.ask(called, way, work.scene); };
        const auto answer_of = [&](Called called) { return ask(called); };
        const std::string cold = answer_of(make()), warm = answer_of(used());
        CHECK(cold.size() > 100 * sizeof(Pair));
        const std::size_t most = test::faults_of_a_name(context, 3);
        test::check_faults(context, faults, Trial{make, ask, cold, most, seed});
        // A failure ends what was kept of the pairs.
        test::check_faults(context, faults, Trial{used, ask, cold, most, seed, false, warm});
    }
}

TEST_CASE("all calls of a narrow phase bear the failure of one of two devices, and of both", "[device]") {
    constexpr std::size_t chunk_pairs = 128;
    const Work work;
    Failing failing(2, true);
    for (const Way& way : ways) {
        if (!runs(failing.context.devices()[0], way)) continue;
        INFO(way.name);
        const auto used = [&] {
            Called called = fresh(failing.context, way, chunk_pairs);
            work.ask(called, way, work.before);
            return called;
        };
        const auto ask = [&](Called& called) { return work.ask(called, way, work.scene); };
        const auto answer_of = [&](Called called) { return ask(called); };
        const std::string cold = answer_of(fresh(failing.context, way, chunk_pairs)), warm = answer_of(used());
        const std::size_t most = test::faults_of_a_name(failing.context, 12);
        CHECK(failing.context.report()[1].opened);
        test::check_crew_faults(failing, Trial{used, ask, cold, most, seed, false, warm});
    }
}
