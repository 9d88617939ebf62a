// Sum, least or largest of uints or floats, in two launches. Every work-item of the first kernel owns one run, read LANES values
// at a time into as many partial results; any work-group size fits.
// Source: two-phase reduction [Harris 2007], runs as long as a CPU likes to read.
//
//   reduce_runs  in, n, per_run (a multiple of LANES), runs -> parts: one a run
//   reduce_last  parts, runs -> out[0]; one work-group. All its work-items stay to the end
// Defines: LANES, VALUE (uint): uint or float; OPERATION (0): 0 sum (modulo 2^32; of floats rounded in the order of the
// runs, which depends on the device), 1 least, 2 largest. Least and largest of floats pass over NaN
#include "common/lanes.clh"

#ifndef VALUE
#define VALUE uint
#endif
#ifndef OPERATION
#define OPERATION 0
#endif

#define IS_uint 1
#define IS_float 2
#define IS_JOIN2(type) IS_##type
#define IS_JOIN(type) IS_JOIN2(type)
#define IS_FLOAT (IS_JOIN(VALUE) == IS_float)

#if LANES == 1
typedef VALUE valueN;
#else
typedef CLINCH_JOIN(VALUE, LANES) valueN;
#endif

#if OPERATION == 0
#define NEUTRAL 0
#define combine(a, b) ((a) + (b))
#elif OPERATION == 1 && IS_FLOAT
#define NEUTRAL INFINITY
#define combine(a, b) fmin(a, b)
#elif OPERATION == 1
#define NEUTRAL 0xffffffffu
#define combine(a, b) min(a, b)
#elif IS_FLOAT
#define NEUTRAL (-INFINITY)
#define combine(a, b) fmax(a, b)
#else
#define NEUTRAL 0u
#define combine(a, b) max(a, b)
#endif

kernel void reduce_runs(global const VALUE* restrict in, uint n, uint per_run, uint runs, global VALUE* restrict parts) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint first = run * per_run, end = n - first > per_run ? first + per_run : n;
    valueN lanes = (valueN)(NEUTRAL);
    uint i = first;
    for (; end - i >= LANES; i += LANES) lanes = combine(lanes, load_lanes(0, in + i));
    VALUE part = NEUTRAL;
    for (; i < end; ++i) part = combine(part, in[i]);
#if LANES == 1
    part = combine(part, lanes);
#else
    VALUE spread[LANES];
    CLINCH_JOIN(vstore, LANES)(lanes, 0, spread);
    for (uint l = 0; l < LANES; ++l) part = combine(part, spread[l]);
#endif
    parts[run] = part;
}

kernel void reduce_last(global const VALUE* restrict parts, uint runs, global VALUE* restrict out, local VALUE* shared) {
    uint item = get_local_id(0), items = get_local_size(0);
    VALUE part = NEUTRAL;
    for (uint i = item; i < runs; i += items) part = combine(part, parts[i]);
    shared[item] = part;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (item == 0) {
        for (uint i = 1; i < items; ++i) part = combine(part, shared[i]);
        out[0] = part;
    }
}
