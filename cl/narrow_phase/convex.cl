// Touches of two convex shapes of classes CONVEX_A and CONVEX_B (CONVEX_A not above CONVEX_B): see convex.clh for the method,
// driver.clh for the kernel and its defines.
#include "narrow_phase/convex.clh"
#define TOUCH touch_convex
#if CONVEX_A == 0
#define CLASS_A 0u
#define TURN_A TURN_NONE
#elif CONVEX_A == 1
#define CLASS_A 1u
#elif CONVEX_A == 2
#define CLASS_A 2u
#elif CONVEX_A == 3
#define CLASS_A 3u
#elif CONVEX_A == 4
#define CLASS_A 4u
#else
#define CLASS_A 6u
#define HULL_A 1
#endif
#if CONVEX_A == CONVEX_B
#define SAME_CLASS 1
#endif
#if CONVEX_B == 6
#define HULL_B 1
#endif
#include "narrow_phase/driver.clh"
