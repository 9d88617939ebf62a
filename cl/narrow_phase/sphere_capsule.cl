// Touches of a sphere with a capsule: see sphere_capsule.clh for the method, driver.clh for the kernel and its defines.
#include "narrow_phase/sphere_capsule.clh"
#define TOUCH touch_sphere_capsule
#define CLASS_A 0u
#define TURN_A TURN_NONE
#define TURN_B TURN_AXIS
#define SIZES_A 1
#define SIZES_B 2
#define NORMAL_B 0
#include "narrow_phase/driver.clh"
