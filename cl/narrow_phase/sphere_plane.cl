// Touches of a sphere with a plane: see sphere_plane.clh for the method, driver.clh for the kernel and its defines.
#include "narrow_phase/sphere_plane.clh"
#define TOUCH touch_sphere_plane
#define CLASS_A 0u
#define TURN_A TURN_NONE
#define TURN_B TURN_WHOLE
#define SIZES_A 1
#define SIZES_B 1
#define NORMAL_B 1
#include "narrow_phase/driver.clh"
