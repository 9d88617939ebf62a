// Compiles cl/common/bounds.clh as C++, so that the host computes the same bytes as a device. The
// library is compiled without contraction of a * b + c (see CMakeLists.txt), which that needs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace clinch::detail {

// Words of OpenCL C that the shared source uses.
using uint = std::uint32_t;
using std::size_t;
inline float as_float(uint bits) {
    float x = 0.0f;
    std::memcpy(&x, &bits, sizeof x);
    return x;
}
inline uint as_uint(float x) {
    uint bits = 0;
    std::memcpy(&bits, &x, sizeof bits);
    return bits;
}

#define CLINCH_GLOBAL
#define CLINCH_FUNCTION inline
#include "cl/common/bounds.clh"
#undef CLINCH_GLOBAL
#undef CLINCH_FUNCTION

static_assert(sizeof(BodyRecord) == 56 && sizeof(ShapeRecord) == 32 && sizeof(BoxRecord) == 24,
              "device and host agree on these layouts");

}  // namespace clinch::detail
