// The closed forms and the boxes' separating axes in float32, as a lane of a device computes them, against the oracle.
#include <catch2/catch.hpp>

#include "tests/narrow_phase/closed_form_cases.hpp"
// Behind all others: it defines words as short as number().
#include "tests/narrow_phase/float_real.hpp"
#define REAL_NAMESPACE host_float
#include "tests/narrow_phase/closed_form_answer.hpp"

using namespace clinch::test;
using clinch::detail::host_float::answer;

TEST_CASE("closed forms in float32 keep what they promise", "[host]") {
    for (const auto& kinds : closed_form_pairs()) {
        const std::uint64_t seed =
            9001 + 10 * static_cast<std::uint64_t>(kinds[0]) + static_cast<std::uint64_t>(kinds[1]);
        Random random(seed);
        const bool boxes = kinds[0] == Kind::box && kinds[1] == Kind::box;
        for (int i = 0; i < (boxes ? 300 : 1000); ++i) {
            const TruePair pair = random_pair(kinds[0], kinds[1], random);
            INFO("seed " << seed << ", case " << i << text_of(pair));
            REQUIRE_THAT(broken_promise(pair, answer(pair), 0x1p-24), Catch::Equals(""));
        }
    }
}

TEST_CASE("a ball on the axis of a body leaves across the axis", "[host]") {
    Random random(31);
    for (const Kind kind : {Kind::capsule, Kind::cylinder, Kind::cone})
        for (int i = 0; i < 1500; ++i) {
            TruePair pair;
            pair.a.size = {0.25};
            pair.b.kind = kind;
            pair.b.size = {0.125, 1};
            for (double& x : pair.b.rotation) x = random.between(-1, 1);
            const double along = random.between(-0.5, 0.5);
            for (std::size_t d = 0; d < 3; ++d) pair.b.position[d] = along * static_cast<double>(axes(pair.b)[2][d]);
            INFO("case " << i << text_of(pair));
            REQUIRE_THAT(broken_promise(pair, answer(pair), 0x1p-24), Catch::Equals(""));
        }
}
