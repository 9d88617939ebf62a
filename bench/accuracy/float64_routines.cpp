// The routines in float64.
#include "bench/accuracy/candidate.hpp"
#include "src/narrow_phase/host_real.hpp"
#define REAL_NAMESPACE host
#include "bench/accuracy/host_routines.hpp"

namespace clinch::accuracy {

void add_float64(test::Kind a, test::Kind b, Candidates& candidates) {
    detail::host::add_routines(a, b, detail::host::routine_of(a, b), {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10, 0},
                               candidates);
}

}  // namespace clinch::accuracy
