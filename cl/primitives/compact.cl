// Compaction: the numbers (or values) of the entries whose flag is not 0, in order. Count, scan, fill: every work-item owns one run
// of consecutive entries, so nothing is shared: no atomics, any work-group size.
// Source: count, scan, fill [Blelloch 1990], a whole run a work-item.
//
//   compact_count  flags, n, per_run, runs -> counts: flags that are set, one a run
//   compact_fill   flags, values, offsets (the scan of counts) -> out: values[i] of entries with a flag; with `number` not 0
//                  their numbers i, and `values` is not read
// Runs are read LANES flags at a time; of LANES flags none of which is set nothing else is looked at.
// Defines: LANES
#include "common/lanes.clh"

// Bits of the set flags among the LANES at `p`.
inline uint flag_bits(global const uint* p) { return lane_bits(as_mask(load_lanes(0, p) != 0)); }

kernel void compact_count(global const uint* restrict flags, uint n, uint per_run, uint runs, global uint* restrict counts) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint i = run * per_run, end = n - i > per_run ? i + per_run : n;
    uint count = 0;
#if LANES > 1
    uintN sums = (uintN)(0);
    for (; end - i >= LANES; i += LANES) sums += min(load_lanes(0, flags + i), (uintN)(1));
    count = sum_lanes(sums);
#endif
    for (; i < end; ++i) count += flags[i] != 0 ? 1 : 0;
    counts[run] = count;
}

kernel void compact_fill(global const uint* restrict flags, global const uint* restrict values, uint n, uint per_run, uint runs,
                         global const uint* restrict offsets, global uint* restrict out, uint number) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint i = run * per_run, end = n - i > per_run ? i + per_run : n;
    uint at = offsets[run];
    for (; end - i >= LANES; i += LANES)
        for (uint bits = flag_bits(flags + i); bits != 0; bits &= bits - 1) {
            uint k = i + lowest_bit(bits);
            out[at++] = number != 0 ? k : values[k];
        }
    for (; i < end; ++i)
        if (flags[i] != 0) out[at++] = number != 0 ? i : values[i];
}
