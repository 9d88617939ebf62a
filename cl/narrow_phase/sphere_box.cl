// Touches of a sphere with a box: see sphere_box.clh for the method, driver.clh for the kernel and its defines.
#include "narrow_phase/sphere_box.clh"
#define TOUCH touch_sphere_box
#define CLASS_A 0u
#define TURN_A TURN_NONE
#define TURN_B TURN_WHOLE
#define SIZES_A 1
#define SIZES_B 3
#define NORMAL_B 0
#include "narrow_phase/driver.clh"
