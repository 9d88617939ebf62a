// Touches of a capsule with a capsule: see capsule_capsule.clh for the method, driver.clh for the kernel and its defines.
#include "narrow_phase/capsule_capsule.clh"
#define TOUCH touch_capsule_capsule
#define CLASS_A 2u
#define SAME_CLASS 1
#define TURN_A TURN_AXIS
#define TURN_B TURN_AXIS
#define SIZES_A 2
#define SIZES_B 2
#define NORMAL_B 0
#include "narrow_phase/driver.clh"
