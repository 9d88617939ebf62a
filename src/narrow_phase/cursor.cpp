#include "src/narrow_phase/cursor.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace clinch::detail {
namespace {

constexpr Measured rows[] = {
#include "src/narrow_phase/measured.inc"
};

// Differences below this are noise of the measurement, or of the next machine.
constexpr double clear = 0.8;

// The loosest tolerance of the general routine that was measured.
constexpr double coarsest = 1e-2;

// Its own tolerance, below which only time is lost: of cylinders and cones, whose bounds meet slowly, and of others.
double finest(const MatrixRow& cell, unsigned bits) {
    const auto curved = [](std::uint8_t kind) { return kind == 3 || kind == 4; };
    if (!curved(cell.a) && !curved(cell.b)) return 0.0;
    return bits == 32 ? 1e-6 : 1e-10;
}

// The error that answers may have, relative to the pair's size.
double needed(const NarrowPhaseOptions& options, double size) {
    if (options.tolerance) return *options.tolerance / size;
    // From 1e-4 for the fastest to 1e-6, which is what float32 can keep, where float64 begins to help.
    return options.precision < 0.25 ? 1e-4 - options.precision * (1e-4 - 1e-6) / 0.25 : 1e-6;
}

bool of_cell(const Measured& m, const MatrixRow& cell) {
    return m.a == cell.a && m.b == cell.b;
}

// The row that stands for a routine whose iterations stop at `tolerance`: the loosest that is no looser; its own if
// there is none.
const Measured* row_for(const MatrixRow& cell, Routine routine, unsigned bits, double tolerance) {
    const Measured* best = nullptr;
    for (const Measured& m : rows) {
        if (!of_cell(m, cell) || m.routine != routine || m.bits != bits) continue;
        const bool fits = m.tolerance < 0.0f || static_cast<double>(m.tolerance) <= tolerance * (1.0 + 1e-6);
        if (fits && (best == nullptr || m.tolerance > best->tolerance)) best = &m;
    }
    return best;
}

// Where iterations may stop in a pass that needs no better than `tolerance`: there, if that is clearly faster than the
// routine's own tolerance, else at that one, which is as good for the price.
double tolerance_for(const MatrixRow& cell, Routine routine, unsigned bits, double tolerance) {
    const double fine = finest(cell, bits), loose = std::clamp(tolerance, fine, coarsest);
    const bool faster = static_cast<double>(row_for(cell, routine, bits, loose)->host_ns) <
                        clear * static_cast<double>(row_for(cell, routine, bits, fine)->host_ns);
    return faster ? loose : fine;
}

// Nanoseconds a pair, on the device and on the host.
struct Cost {
    double device = 0.0, host = 0.0;
};

// What was not measured on a device is taken to gain there what the cell's own routine does.
Cost cost_of(const MatrixRow& cell, const Measured& m) {
    const auto host = static_cast<double>(m.host_ns);
    if (m.device_ns > 0.0f) return {static_cast<double>(m.device_ns), host};
    const Measured* own = row_for(cell, Routine::own, m.bits, -1.0);
    return {host * static_cast<double>(own->device_ns) / static_cast<double>(own->host_ns), host};
}

// In both places: one alone may have been disturbed.
bool clearly_less(const Cost& a, const Cost& b) {
    return a.device < clear * b.device && a.host < clear * b.host;
}

// Share of pairs whose float32 answer promises less than is needed.
double left_over(const Measured& m, double need) {
    if (static_cast<double>(m.promised_p99) <= need) return 0.01;
    return static_cast<double>(m.promised_median) <= need ? 0.5 : 1.0;
}

struct Choice {
    Plan plan;
    Cost cost;
};

Choice choice_of(const MatrixRow& cell, Routine routine, const NarrowPhaseOptions& options, double need) {
    Choice choice;
    Plan& plan = choice.plan;
    plan.routine = routine;
    // Half: what bounds leave apart and what rounding adds make up the error together.
    plan.tolerance32 = tolerance_for(cell, routine, 32, need / 2);
    // Of few pairs, to decide whether they touch, or of all: then only as exact as asked.
    plan.tolerance64 = finest(cell, 64);
    const double loose = options.tolerance ? tolerance_for(cell, routine, 64, need / 2) : plan.tolerance64;
    const Measured* const row_loose = row_for(cell, routine, 64, loose);
    plan.row32 = row_for(cell, routine, 32, plan.tolerance32);
    plan.row64 = row_for(cell, routine, 64, plan.tolerance64);
    const Cost cost32 = cost_of(cell, *plan.row32), cost64 = cost_of(cell, *plan.row64);
    const Cost alone = cost_of(cell, *row_loose);
    const bool fast = !options.tolerance && options.precision < 0.25;
    const bool exact = !options.tolerance && options.precision >= 0.75;
    const double again = fast ? 0.0 : options.tolerance ? left_over(*plan.row32, need) : 0.01;
    const Cost both{cost32.device + again * cost64.device, cost32.host + again * cost64.host};
    if (exact || again >= 1.0 || clearly_less(alone, both)) {
        plan.passes = Passes::float64;
        plan.tolerance64 = loose;
        plan.row32 = nullptr;
        plan.row64 = row_loose;
        choice.cost = alone;
    } else {
        plan.passes = fast ? Passes::float32 : Passes::float32_then_64;
        if (fast) plan.row64 = nullptr;
        choice.cost = both;
    }
    return choice;
}

double reach_of(const NarrowShape64& shape, const double* vertices) {
    const double x = shape.size[0], y = shape.size[1], z = shape.size[2];
    switch (shape.kind) {
        case 0:
        case 5:
            return std::fabs(x);
        case 1:
            return std::sqrt(x * x + y * y + z * z);
        case 2:
            return x + y;
        case 6: {
            double square = 0.0;
            for (std::uint32_t i = 0; i < shape.vertex_count; ++i) {
                const double* p = vertices + shape.first_vertex + i;
                const double q[3] = {p[0], p[shape.stride], p[2 * std::size_t{shape.stride}]};
                square = std::max(square, q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
            }
            return std::sqrt(square);
        }
        default:
            return std::sqrt(x * x + y * y);
    }
}

}  // namespace

View<const Measured> measured() {
    return {rows, std::size(rows)};
}

Plan plan_of(const MatrixRow& cell, const NarrowPhaseOptions& options, double size) {
    const double need = needed(options, size);
    const Choice own = choice_of(cell, Routine::own, options, need);
    // Where the cell's own routine is the general one, or there is a plane, no other was measured.
    if (row_for(cell, Routine::general, 32, -1.0) == nullptr) return own.plan;
    const Choice general = choice_of(cell, Routine::general, options, need);
    return clearly_less(general.cost, own.cost) ? general.plan : own.plan;
}

double largest_pair(const NarrowShapes& shapes, const MatrixRow& cell) {
    double a = 0.0, b = 0.0;
    for (const NarrowShape64& shape : shapes.records()) {
        if (shape.kind != cell.a && shape.kind != cell.b) continue;
        const double reach = reach_of(shape, shapes.vertices().data());
        if (shape.kind == cell.a) a = std::max(a, reach);
        if (shape.kind == cell.b) b = std::max(b, reach);
    }
    // Bodies that touch are no farther from each other than they reach. A plane's position may be anywhere on it.
    return 2.0 * (a + b);
}

}  // namespace clinch::detail
