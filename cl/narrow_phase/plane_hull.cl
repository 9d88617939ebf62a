// Touches of a plane with a hull: see plane_hull.clh for the method, driver.clh for the kernel and its defines.
#include "narrow_phase/plane_hull.clh"
#define TOUCH touch_plane_hull
#define CLASS_A 5u
#define TURN_A TURN_WHOLE
#define TURN_B TURN_WHOLE
#define SIZES_A 1
#define SIZES_B 0
#define NORMAL_A 1
#define HULL_B 1
#include "narrow_phase/driver.clh"
