// Touches of a box with a plane: see box_plane.clh for the method, driver.clh for the kernel and its defines.
#include "narrow_phase/box_plane.clh"
#define TOUCH touch_box_plane
#define CLASS_A 1u
#define TURN_A TURN_WHOLE
#define TURN_B TURN_WHOLE
#define SIZES_A 3
#define SIZES_B 1
#define NORMAL_B 1
#include "narrow_phase/driver.clh"
