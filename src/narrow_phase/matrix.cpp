#include "src/narrow_phase/matrix.hpp"

#include <iterator>

#include "clinch/error.hpp"

namespace clinch::detail {
namespace {

constexpr const char* class_names[] = {"sphere", "box", "capsule", "cylinder", "cone", "plane", "hull"};

// Closed forms where there is one; GJK and EPA for all other convex shapes.
constexpr MatrixRow rows[] = {
    {"narrow_phase/sphere_sphere", "", host_sphere_sphere, 0, 0, true},
    {"narrow_phase/sphere_box", "", host_sphere_box, 0, 1, true},
    {"narrow_phase/sphere_capsule", "", host_sphere_capsule, 0, 2, true},
    {"narrow_phase/sphere_cylinder", "", host_sphere_cylinder, 0, 3, true},
    {"narrow_phase/sphere_cone", "", host_sphere_cone, 0, 4, true},
    {"narrow_phase/sphere_plane", "", host_sphere_plane, 0, 5, true},
    {"narrow_phase/convex", "-DCONVEX_A=0 -DCONVEX_B=6", host_convex<0, 6>, 0, 6, false},
    {"narrow_phase/box_box", "", host_box_box, 1, 1, true},
    {"narrow_phase/convex", "-DCONVEX_A=1 -DCONVEX_B=2", host_convex<1, 2>, 1, 2, false},
    {"narrow_phase/convex", "-DCONVEX_A=1 -DCONVEX_B=3", host_convex<1, 3>, 1, 3, false},
    {"narrow_phase/convex", "-DCONVEX_A=1 -DCONVEX_B=4", host_convex<1, 4>, 1, 4, false},
    {"narrow_phase/box_plane", "", host_box_plane, 1, 5, true},
    {"narrow_phase/convex", "-DCONVEX_A=1 -DCONVEX_B=6", host_convex<1, 6>, 1, 6, false},
    {"narrow_phase/capsule_capsule", "", host_capsule_capsule, 2, 2, true},
    {"narrow_phase/convex", "-DCONVEX_A=2 -DCONVEX_B=3", host_convex<2, 3>, 2, 3, false},
    {"narrow_phase/convex", "-DCONVEX_A=2 -DCONVEX_B=4", host_convex<2, 4>, 2, 4, false},
    {"narrow_phase/capsule_plane", "", host_capsule_plane, 2, 5, true},
    {"narrow_phase/convex", "-DCONVEX_A=2 -DCONVEX_B=6", host_convex<2, 6>, 2, 6, false},
    {"narrow_phase/convex", "-DCONVEX_A=3 -DCONVEX_B=3", host_convex<3, 3>, 3, 3, false},
    {"narrow_phase/convex", "-DCONVEX_A=3 -DCONVEX_B=4", host_convex<3, 4>, 3, 4, false},
    {"narrow_phase/cylinder_plane", "", host_cylinder_plane, 3, 5, true},
    {"narrow_phase/convex", "-DCONVEX_A=3 -DCONVEX_B=6", host_convex<3, 6>, 3, 6, false},
    {"narrow_phase/convex", "-DCONVEX_A=4 -DCONVEX_B=4", host_convex<4, 4>, 4, 4, false},
    {"narrow_phase/cone_plane", "", host_cone_plane, 4, 5, true},
    {"narrow_phase/convex", "-DCONVEX_A=4 -DCONVEX_B=6", host_convex<4, 6>, 4, 6, false},
    {"narrow_phase/plane_hull", "", host_plane_hull, 5, 6, false},
    {"narrow_phase/convex", "-DCONVEX_A=6 -DCONVEX_B=6", host_convex<6, 6>, 6, 6, false},
};

constexpr std::array<std::uint8_t, 64> make_table() {
    std::array<std::uint8_t, 64> table{};
    for (std::uint8_t& entry : table) entry = no_bucket;
    for (std::size_t i = 0; i < std::size(rows); ++i) {
        table[std::size_t{8} * rows[i].a + rows[i].b] = static_cast<std::uint8_t>(i);
        table[std::size_t{8} * rows[i].b + rows[i].a] = static_cast<std::uint8_t>(i);
    }
    return table;
}

constexpr std::array<std::uint8_t, 64> table = make_table();

// A pair of classes without a routine does not compile.
constexpr bool is_whole() {
    for (std::size_t a = 0; a < narrow_classes; ++a)
        for (std::size_t b = a; b < narrow_classes; ++b)
            if ((table[8 * a + b] == no_bucket) != (a == plane_class && b == plane_class)) return false;
    return std::size(rows) < no_bucket;
}
static_assert(is_whole(), "each pair of classes but two planes has one row");

}  // namespace

View<const MatrixRow> matrix() {
    return {rows, std::size(rows)};
}

const std::array<std::uint8_t, 64>& bucket_table() {
    return table;
}

std::string classes_text(const MatrixRow& row) {
    return std::string(class_names[row.a]) + '-' + class_names[row.b];
}

std::string number_defines(const DeviceInfo& device, unsigned bits) {
    return " -DREAL_BITS=" + std::to_string(bits) +
           (device.exact_division ? " -DEXACT_FP32=1 -cl-fp32-correctly-rounded-divide-sqrt" : "");
}

void throw_no_routine(const Pair& pair) {
    throw Error(ErrorCode::InvalidArgument, "the pair " + std::to_string(pair.a) + ", " + std::to_string(pair.b) +
                                                " cannot be tested: pairs with a < b of bodies that are there and not "
                                                "rejected are accepted, but not of two planes, nor with a mesh");
}

}  // namespace clinch::detail
