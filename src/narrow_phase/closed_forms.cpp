// The closed forms on the host.
#include "src/narrow_phase/routines.hpp"

namespace clinch::detail {
namespace host {
#include "cl/narrow_phase/box_box.clh"
#include "cl/narrow_phase/box_plane.clh"
#include "cl/narrow_phase/capsule_capsule.clh"
#include "cl/narrow_phase/capsule_plane.clh"
#include "cl/narrow_phase/cone_plane.clh"
#include "cl/narrow_phase/cylinder_plane.clh"
#include "cl/narrow_phase/plane_hull.clh"
#include "cl/narrow_phase/sphere_box.clh"
#include "cl/narrow_phase/sphere_capsule.clh"
#include "cl/narrow_phase/sphere_cone.clh"
#include "cl/narrow_phase/sphere_cylinder.clh"
#include "cl/narrow_phase/sphere_plane.clh"
#include "cl/narrow_phase/sphere_sphere.clh"
}  // namespace host

#define CLINCH_HOST_ROUTINE(pair)                                                                      \
    void host_##pair(const host::Side* a, const host::Side* b, host::v3 between, host::Touch* touch) { \
        host::touch_##pair(a, b, between, touch);                                                      \
    }
CLINCH_HOST_ROUTINE(sphere_sphere)
CLINCH_HOST_ROUTINE(sphere_box)
CLINCH_HOST_ROUTINE(sphere_capsule)
CLINCH_HOST_ROUTINE(sphere_cylinder)
CLINCH_HOST_ROUTINE(sphere_cone)
CLINCH_HOST_ROUTINE(sphere_plane)
CLINCH_HOST_ROUTINE(box_box)
CLINCH_HOST_ROUTINE(box_plane)
CLINCH_HOST_ROUTINE(capsule_capsule)
CLINCH_HOST_ROUTINE(capsule_plane)
CLINCH_HOST_ROUTINE(cylinder_plane)
CLINCH_HOST_ROUTINE(cone_plane)
CLINCH_HOST_ROUTINE(plane_hull)
#undef CLINCH_HOST_ROUTINE

}  // namespace clinch::detail
