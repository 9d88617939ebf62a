// The precision cursor: which routine a bucket is done with, in which precision first, and when iterations may stop
// [thesis 3.2.1.1]. Chosen from times and errors that were measured once (bench/accuracy) and are compiled in, never
// from what this machine does now: the same input takes the same plan, and so gives the same bytes, everywhere.
#pragma once

#include <cstdint>

#include "clinch/narrow_phase.hpp"
#include "clinch/view.hpp"
#include "src/narrow_phase/matrix.hpp"
#include "src/narrow_phase/narrow_scene.hpp"

namespace clinch::detail {

/// What can answer a pair: the routine of the cell's matrix row, or the general one (cl/narrow_phase/convex.clh), which
/// is measured beside every closed form and has never been the faster one; a test holds that, for only `own` is run.
enum class Routine : std::uint8_t { own, general };

/// One measured candidate of a cell. Errors are relative to the pair's size: reaches of both bodies and the way between
/// their positions together, of a plane also its offset.
struct Measured {
    std::uint8_t a, b;  ///< class numbers, as in MatrixRow
    Routine routine;
    std::uint8_t bits;      ///< 32 or 64
    float tolerance;        ///< at which its iterations stop, relative; below 0: its own
    float device_ns;        ///< a pair, on a device with two cores; 0: not measured there
    float host_ns;          ///< a pair, one core
    float worst;            ///< actual error, over poses as hostile as could be thought of
    float promised_median;  ///< error that half of the answers to usual poses promise, or less
    float promised_p99;     ///< and 99 of 100
};

/// All candidates, by cell; the file measured.inc, which `clinch_accuracy --table` writes.
View<const Measured> measured();

/// Precisions in which a bucket is done.
enum class Passes : std::uint8_t {
    float32,          ///< alone; whether pairs nearer than their error touch stays open
    float32_then_64,  ///< and float64 for the pairs that float32 leaves undecided or above the tolerance
    float64           ///< alone: float32 would leave most pairs to it, or is no faster
};

struct Plan {
    Passes passes = Passes::float32_then_64;
    Routine routine = Routine::own;
    /// Where iterations may stop in either precision, as touch_convex_within() takes it: relative to the pair's size.
    /// Closed forms have none.
    double tolerance32 = 0.0, tolerance64 = 0.0;
    /// The rows of the table that stand for the passes; null where there is no such pass.
    const Measured *row32 = nullptr, *row64 = nullptr;
};

/// The least expensive plan for a cell that keeps what the options ask of most pairs. `size` > 0: the largest pair of
/// the bucket, or a bound on it; only `tolerance` looks at it. A plan that expects too much costs time or leaves errors
/// above the tolerance, which answers tell; it breaks no promise. Cost: a look through the cell's rows.
Plan plan_of(const MatrixRow& cell, const NarrowPhaseOptions& options, double size);

/// Upper bound on the size of those pairs of a cell that touch, from the largest shapes of both classes; 0 where a
/// class has no shape. Linear in the number of shapes and vertices.
double largest_pair(const NarrowShapes& shapes, const MatrixRow& cell);

}  // namespace clinch::detail
