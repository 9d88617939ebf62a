// Touches of a capsule with a plane: see capsule_plane.clh for the method, driver.clh for the kernel and its defines.
#include "narrow_phase/capsule_plane.clh"
#define TOUCH touch_capsule_plane
#define CLASS_A 2u
#define TURN_A TURN_AXIS
#define TURN_B TURN_WHOLE
#define SIZES_A 2
#define SIZES_B 1
#define NORMAL_B 1
#include "narrow_phase/driver.clh"
