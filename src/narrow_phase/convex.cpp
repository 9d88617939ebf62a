// GJK and EPA on the host.
#include "src/narrow_phase/routines.hpp"

namespace clinch::detail {
namespace host {
#include "cl/narrow_phase/convex.clh"
}  // namespace host

template <int A, int B>
void host_convex(const host::Side* a, const host::Side* b, host::v3 between, host::Touch* touch) {
    host::touch_convex_of(static_cast<host::uint>(A), static_cast<host::uint>(B), a, b, between, touch);
}

#define CLINCH_HOST_CONVEX(a, b) \
    template void host_convex<a, b>(const host::Side*, const host::Side*, host::v3, host::Touch*);
CLINCH_HOST_CONVEX(0, 6)
CLINCH_HOST_CONVEX(1, 2)
CLINCH_HOST_CONVEX(1, 3)
CLINCH_HOST_CONVEX(1, 4)
CLINCH_HOST_CONVEX(1, 6)
CLINCH_HOST_CONVEX(2, 3)
CLINCH_HOST_CONVEX(2, 4)
CLINCH_HOST_CONVEX(2, 6)
CLINCH_HOST_CONVEX(3, 3)
CLINCH_HOST_CONVEX(3, 4)
CLINCH_HOST_CONVEX(3, 6)
CLINCH_HOST_CONVEX(4, 4)
CLINCH_HOST_CONVEX(4, 6)
CLINCH_HOST_CONVEX(6, 6)
#undef CLINCH_HOST_CONVEX

}  // namespace clinch::detail
