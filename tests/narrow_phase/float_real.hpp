// As src/narrow_phase/host_real.hpp, but in float32: what a device computes in a lane, so that its error can be tested
// against an oracle without a device.
#pragma once

#include <cmath>
#include <cstdint>

namespace clinch::detail::host_float {

using real = float;
using mask = bool;
using uint = std::uint32_t;
using std::fabs;
using std::fmax;
using std::fmin;

template <class T>
T choose(bool m, T yes, T no) {
    return m ? yes : no;
}
inline bool negate(bool m) {
    return !m;
}
inline bool any_lane(bool m) {
    return m;
}
inline float root_of(float x) {
    return std::sqrt(x);
}
inline float quotient(float a, float b) {
    return a / b;
}
#define REAL_BITS 32
#define PAIR_LANES 1
#define number(x) (x##f)
#define REAL_FUNCTION inline
#define REAL_GLOBAL
#define REAL_SCALAR float

}  // namespace clinch::detail::host_float
