// Touches of a cone with a plane: see cone_plane.clh for the method, driver.clh for the kernel and its defines.
#include "narrow_phase/cone_plane.clh"
#define TOUCH touch_cone_plane
#define CLASS_A 4u
#define TURN_A TURN_AXIS
#define TURN_B TURN_WHOLE
#define SIZES_A 2
#define SIZES_B 1
#define NORMAL_B 1
#include "narrow_phase/driver.clh"
