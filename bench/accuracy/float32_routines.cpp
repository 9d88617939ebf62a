// The routines in float32.
#include "bench/accuracy/candidate.hpp"
#include "tests/narrow_phase/float_real.hpp"
#define REAL_NAMESPACE host_float
#include "bench/accuracy/host_routines.hpp"

namespace clinch::accuracy {

void add_float32(test::Kind a, test::Kind b, Candidates& candidates) {
    detail::host_float::add_routines(a, b, detail::host_float::routine_of(a, b), {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 0},
                                     candidates);
}

}  // namespace clinch::accuracy
