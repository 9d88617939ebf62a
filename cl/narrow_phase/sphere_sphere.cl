// Touches of a sphere with a sphere: see sphere_sphere.clh for the method, driver.clh for the kernel and its defines.
#include "narrow_phase/sphere_sphere.clh"
#define TOUCH touch_sphere_sphere
#define CLASS_A 0u
#define SAME_CLASS 1
#define TURN_A TURN_NONE
#define TURN_B TURN_NONE
#define SIZES_A 1
#define SIZES_B 1
#define NORMAL_B 0
#include "narrow_phase/driver.clh"
