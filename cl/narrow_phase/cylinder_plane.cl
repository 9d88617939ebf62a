// Touches of a cylinder with a plane: see cylinder_plane.clh for the method, driver.clh for the kernel and its defines.
#include "narrow_phase/cylinder_plane.clh"
#define TOUCH touch_cylinder_plane
#define CLASS_A 3u
#define TURN_A TURN_AXIS
#define TURN_B TURN_WHOLE
#define SIZES_A 2
#define SIZES_B 1
#define NORMAL_B 1
#include "narrow_phase/driver.clh"
