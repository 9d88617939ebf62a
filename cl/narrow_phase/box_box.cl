// Touches of a box with a box: see box_box.clh for the method, driver.clh for the kernel and its defines.
#include "narrow_phase/box_box.clh"
#define TOUCH touch_box_box
#define CLASS_A 1u
#define SAME_CLASS 1
#define TURN_A TURN_WHOLE
#define TURN_B TURN_WHOLE
#define SIZES_A 3
#define SIZES_B 3
#define NORMAL_B 0
#include "narrow_phase/driver.clh"
