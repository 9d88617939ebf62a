// Touches of a sphere with a sphere: see sphere_sphere.clh for the method, driver.clh for the kernel and its defines.
#include "narrow_phase/sphere_sphere.clh"
#define TOUCH touch_sphere_sphere
#define CLASS_A 0u
#define TURN_A 0
#define TURN_B 0
#define SIZES_A 1
#define SIZES_B 1
#define NORMAL_B 0
#include "narrow_phase/driver.clh"
