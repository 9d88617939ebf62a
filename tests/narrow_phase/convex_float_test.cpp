// The general convex routine in float32, as a device computes it, against the oracles.
#include <catch2/catch.hpp>
#include <cstdint>

#include "tests/narrow_phase/convex_cases.hpp"
// Behind all others: it defines words as short as number().
#include "tests/narrow_phase/float_real.hpp"
#define REAL_NAMESPACE host_float
#include "tests/narrow_phase/convex_answer.hpp"

using namespace clinch::test;
using clinch::detail::host_float::convex_answer;

TEST_CASE("convex routine in float32 keeps what it promises", "[host]") {
    constexpr double unit = 0x1p-24;
    constexpr std::uint32_t classes[] = {0, 1, 2, 3, 4, 6};
    for (const std::uint32_t a : classes)
        for (const std::uint32_t b : classes) {
            if (a > b) continue;
            const std::uint64_t seed = 8000 + 10 * a + b;
            Random random(seed);
            for (const Regime regime :
                 {Regime::any, Regime::flat, Regime::unequal, Regime::parallel, Regime::nearly_parallel,
                  Regime::concentric, Regime::nearly_concentric, Regime::far_scale})
                for (int i = 0; i < 40; ++i) {
                    ConvexBodies pair = random_bodies(a, b, regime, random);
                    for (int touching = 0; touching < 2; ++touching) {
                        const ConvexAnswer answer = convex_answer(pair);
                        INFO("seed " << seed << ", regime " << static_cast<int>(regime) << ", case " << i
                                     << text_of(pair));
                        REQUIRE_THAT(broken_promise(pair, answer, unit, 2e-6, false, random), Catch::Equals(""));
                        // Flat, unequal, parallel, concentric and touching bodies have slivers and ties, which answers
                        // tell of.
                        const bool plain = touching == 0 && (regime == Regime::any || regime == Regime::far_scale);
                        REQUIRE(answer.error <= (plain ? 1e-5 : 4e-3) * size_of(pair));
                        move(pair.b, answer.normal, -answer.distance);
                    }
                }
        }
}
