// The algorithm matrix: shape class x shape class -> the routine that answers [thesis 3.2.1].
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "clinch/aabb.hpp"
#include "clinch/device.hpp"
#include "clinch/view.hpp"
#include "src/narrow_phase/routines.hpp"

namespace clinch::detail {

/// Classes of shapes that have routines, by number: the index of the alternative in clinch::Shape. A mesh has none yet.
constexpr std::size_t narrow_classes = 7;
constexpr std::uint8_t sphere_class = 0, box_class = 1, plane_class = 5;

/// One cell. A's class is not above B's.
struct MatrixRow {
    const char* module;   ///< the kernel's, in cl/narrow_phase/
    const char* defines;  ///< that the module is built with
    HostTouch host;       ///< the same routine in float64 on the host
    std::uint8_t a, b;    ///< class numbers
    bool lanes;           ///< a work-item does several pairs at once
};

/// All cells, in the order of their buckets. A new pair of classes is one header in cl/narrow_phase/, one module and
/// one row.
View<const MatrixRow> matrix();
/// Bucket of the classes at 8 a + b, for both orders; `no_bucket` where there is none: two planes, or a mesh.
constexpr std::uint8_t no_bucket = 31;
const std::array<std::uint8_t, 64>& bucket_table();
/// "sphere-box"
std::string classes_text(const MatrixRow& row);
/// What kernels that compute with real.clh are built with, for numbers of `bits` on a device.
std::string number_defines(const DeviceInfo& device, unsigned bits);
/// InvalidArgument for a pair that the matrix has no cell for, or whose bodies cannot touch.
[[noreturn]] void throw_no_routine(const Pair& pair);

}  // namespace clinch::detail
