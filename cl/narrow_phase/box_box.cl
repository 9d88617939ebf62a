// Touches of a box with a box: see box_box.clh for the method, driver.clh for the kernel and its defines.
#include "narrow_phase/box_box.clh"
#define TOUCH touch_box_box
#define CLASS_A 1u
#define TURN_A 1
#define TURN_B 1
#define SIZES_A 3
#define SIZES_B 3
#define NORMAL_B 0
#include "narrow_phase/driver.clh"
