// The narrow-phase routines in float64 on the host: the very source that devices run (cl/narrow_phase/*.clh).
#pragma once

#include "src/narrow_phase/host_real.hpp"

namespace clinch::detail {
namespace host {
#include "cl/narrow_phase/touch.clh"
}  // namespace host

/// Answers for A and B in the frame of the pair; see touch.clh.
using HostTouch = void (*)(const host::Side* a, const host::Side* b, host::v3 between, host::Touch* touch);

void host_sphere_sphere(const host::Side* a, const host::Side* b, host::v3 between, host::Touch* touch);
void host_sphere_box(const host::Side* a, const host::Side* b, host::v3 between, host::Touch* touch);
void host_sphere_capsule(const host::Side* a, const host::Side* b, host::v3 between, host::Touch* touch);
void host_sphere_cylinder(const host::Side* a, const host::Side* b, host::v3 between, host::Touch* touch);
void host_sphere_cone(const host::Side* a, const host::Side* b, host::v3 between, host::Touch* touch);
void host_sphere_plane(const host::Side* a, const host::Side* b, host::v3 between, host::Touch* touch);
void host_box_box(const host::Side* a, const host::Side* b, host::v3 between, host::Touch* touch);
void host_box_plane(const host::Side* a, const host::Side* b, host::v3 between, host::Touch* touch);
void host_capsule_capsule(const host::Side* a, const host::Side* b, host::v3 between, host::Touch* touch);
void host_capsule_plane(const host::Side* a, const host::Side* b, host::v3 between, host::Touch* touch);
void host_cylinder_plane(const host::Side* a, const host::Side* b, host::v3 between, host::Touch* touch);
void host_cone_plane(const host::Side* a, const host::Side* b, host::v3 between, host::Touch* touch);
void host_plane_hull(const host::Side* a, const host::Side* b, host::v3 between, host::Touch* touch);
/// Convex shapes of classes A and B.
template <int A, int B>
void host_convex(const host::Side* a, const host::Side* b, host::v3 between, host::Touch* touch);

}  // namespace clinch::detail
