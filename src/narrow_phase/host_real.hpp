// The words of OpenCL C that narrow-phase routines use, as C++ for float64, one pair at a time. Include it inside no
// namespace, then the routines' headers inside namespace clinch::detail::host.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace clinch::detail::host {

using real = double;
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
inline double root_of(double x) {
    return std::sqrt(x);
}
inline double quotient(double a, double b) {
    return a / b;
}
#define REAL_BITS 64
#define PAIR_LANES 1
#define number(x) (x)
#define REAL_FUNCTION inline
#define REAL_GLOBAL
#define REAL_SCALAR double

}  // namespace clinch::detail::host
