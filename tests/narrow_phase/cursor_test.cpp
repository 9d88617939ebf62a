// The precision cursor: what it takes from the measured table, and that answers then keep what was asked.
#include "src/narrow_phase/cursor.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <tuple>

#include "clinch/scene.hpp"
// Behind the library's headers: convex_answer.hpp takes its words from src/narrow_phase/host_real.hpp.
#define REAL_NAMESPACE host
#include "tests/narrow_phase/convex_answer.hpp"

using namespace clinch;
using namespace clinch::detail;

namespace {

NarrowPhaseOptions precision_of(double precision) {
    NarrowPhaseOptions options;
    options.precision = precision;
    return options;
}

NarrowPhaseOptions tolerance_of(double tolerance) {
    NarrowPhaseOptions options;
    options.tolerance = tolerance;
    return options;
}

bool is_curved(const MatrixRow& cell) {
    return cell.a == 3 || cell.a == 4 || cell.b == 3 || cell.b == 4;
}

bool is_convex(const MatrixRow& cell) {
    return std::string(cell.module) == "narrow_phase/convex";
}

const Measured* own_row(const MatrixRow& cell, unsigned bits) {
    for (const Measured& m : measured())
        if (m.a == cell.a && m.b == cell.b && m.routine == Routine::own && m.bits == bits && m.tolerance < 0.0f)
            return &m;
    return nullptr;
}

bool same(const Plan& p, const Plan& q) {
    return std::tie(p.passes, p.routine, p.tolerance32, p.tolerance64, p.row32, p.row64) ==
           std::tie(q.passes, q.routine, q.tolerance32, q.tolerance64, q.row32, q.row64);
}

}  // namespace

TEST_CASE("the measured table has every cell, in both precisions and on a device", "[host]") {
    for (const MatrixRow& cell : matrix())
        for (const unsigned bits : {32u, 64u}) {
            INFO(classes_text(cell) << " in " << bits << " bits");
            const Measured* m = own_row(cell, bits);
            REQUIRE(m != nullptr);
            CHECK(m->device_ns > 0.0f);
            CHECK(m->host_ns > 0.0f);
            CHECK(m->promised_median > 0.0f);
            CHECK(m->promised_median <= m->promised_p99);
            // What closed forms owe; iterations have ties and slivers, which their answers tell of.
            if (!is_convex(cell)) CHECK(m->worst <= (bits == 32 ? 4e-7f : 1e-14f));
            CHECK(m->promised_median <= (bits == 32 ? 1e-5f : is_curved(cell) ? 2e-10f : 1e-14f));
        }
}

TEST_CASE("the cursor takes the passes that a precision stands for", "[host]") {
    for (const MatrixRow& cell : matrix()) {
        INFO(classes_text(cell));
        const Plan fast = plan_of(cell, precision_of(0.0), 1.0), usual = plan_of(cell, precision_of(0.5), 1.0),
                   exact = plan_of(cell, precision_of(1.0), 1.0);
        // Where float64 was clearly the faster one, it may take float32's place.
        CHECK((fast.passes == Passes::float32 || fast.row64->host_ns < own_row(cell, 32)->host_ns));
        CHECK((usual.passes == Passes::float32_then_64 || usual.passes == fast.passes));
        CHECK(exact.passes == Passes::float64);
        CHECK(exact.tolerance64 == (is_curved(cell) ? 1e-10 : 0.0));
        CHECK(fast.tolerance32 <= 1e-4);
        CHECK(fast.tolerance32 >= usual.tolerance32);
        // The size does not matter without a tolerance.
        CHECK(same(usual, plan_of(cell, precision_of(0.5), 1e6)));
    }
}

TEST_CASE("the cursor takes float64 alone when float32 would miss the tolerance for most pairs", "[host]") {
    for (const MatrixRow& cell : matrix()) {
        INFO(classes_text(cell));
        const double promised = static_cast<double>(own_row(cell, 32)->promised_median);
        CHECK(plan_of(cell, tolerance_of(promised / 3), 1.0).passes == Passes::float64);
        CHECK(plan_of(cell, tolerance_of(1e-12), 1.0).passes == Passes::float64);
        const Plan loose = plan_of(cell, tolerance_of(1e-2), 1.0);
        CHECK((loose.passes == Passes::float32_then_64 ||
               loose.row64->host_ns < own_row(cell, 32)->host_ns + own_row(cell, 64)->host_ns));
        // A larger pair has larger errors.
        CHECK(plan_of(cell, tolerance_of(1e-2), 1e6).passes == Passes::float64);
        for (double tolerance = 1e-14; tolerance < 1.0; tolerance *= 7) {
            const Plan plan = plan_of(cell, tolerance_of(tolerance), 1.0);
            CHECK(same(plan, plan_of(cell, tolerance_of(tolerance * 1024), 1024.0)));
            // Never looser than asked, unless the routine cannot do better.
            CHECK((plan.tolerance32 <= tolerance || plan.tolerance32 == 1e-6));
            CHECK((plan.tolerance64 <= tolerance || plan.tolerance64 == 1e-10));
        }
    }
}

TEST_CASE("a closed form is taken where there is one", "[host]") {
    for (const MatrixRow& cell : matrix()) {
        if (is_convex(cell)) continue;
        INFO(classes_text(cell));
        for (const double precision : {0.0, 0.3, 0.5, 0.8, 1.0})
            CHECK(plan_of(cell, precision_of(precision), 1.0).routine == Routine::own);
        for (const double tolerance : {1e-2, 1e-5, 1e-8, 1e-13})
            CHECK(plan_of(cell, tolerance_of(tolerance), 1.0).routine == Routine::own);
    }
}

TEST_CASE("iterations that stop where the cursor says meet the tolerance", "[host]") {
    for (const MatrixRow& cell : matrix()) {
        if (!is_convex(cell)) continue;
        const std::uint64_t seed = 9100 + std::uint64_t{10} * cell.a + cell.b;
        test::Random random(seed);
        INFO(classes_text(cell) << ", seed " << seed);
        for (const double tolerance : {1e-2, 1e-4, 1e-7}) {
            int met = 0;
            constexpr int pairs = 200;
            for (int i = 0; i < pairs; ++i) {
                const test::ConvexBodies pair = test::random_bodies(cell.a, cell.b, test::Regime::any, random);
                const double size = test::size_of(pair);
                const Plan plan = plan_of(cell, tolerance_of(tolerance * size), size);
                if (host::convex_answer(pair, 1e300, plan.tolerance64).error <= tolerance * size) ++met;
            }
            INFO("tolerance " << tolerance);
            CHECK(met >= pairs * 98 / 100);
        }
    }
}

TEST_CASE("the largest pair of a cell bounds all pairs that touch", "[host]") {
    Scene scene;
    NarrowShapes shapes;
    shapes.update(scene);
    CHECK(largest_pair(shapes, matrix()[0]) == 0.0);
    scene.add_shape(Sphere{0.5});
    scene.add_shape(Sphere{2.0});
    scene.add_shape(Box{{1, 2, 2}});
    scene.add_shape(Hull{{{0, 0, 0}, {3, 0, 0}, {0, 4, 0}, {0, 0, 1}}});
    shapes.update(scene);
    for (const MatrixRow& cell : matrix()) {
        const std::string classes = classes_text(cell);
        if (classes == "sphere-sphere") CHECK(largest_pair(shapes, cell) == 8.0);
        if (classes == "sphere-box") CHECK(largest_pair(shapes, cell) == 10.0);
        if (classes == "box-hull") CHECK(largest_pair(shapes, cell) == 14.0);
    }
}
