// Stable radix sort of unsigned keys with a 32-bit payload, last digit first; count, scan and scatter a digit.
// Every work-item owns one run of consecutive keys and counters of its own, so nothing is shared: no
// atomics, no local memory, any work-group size.
//
//   radix_count    keys, n, per_run, runs, shift, digits -> counts[digit * runs + run]
//   radix_scatter  keys, payload, offsets (the scan of counts) -> keys and payload in order of this digit
// Defines: RADIX_BITS (8): most bits of a digit, of which there are `digits`, a power of two; KEY (uint): type of a key, uint or ulong
#ifndef RADIX_BITS
#define RADIX_BITS 8
#endif
#ifndef KEY
#define KEY uint
#endif
#define MAX_DIGITS (1u << RADIX_BITS)

inline uint digit_of(KEY key, uint shift, uint digits) { return (uint)(key >> shift) & (digits - 1); }

kernel void radix_count(global const KEY* restrict keys, uint n, uint per_run, uint runs, uint shift,
                        uint digits, global uint* restrict counts) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint mine[MAX_DIGITS];
    for (uint d = 0; d < digits; ++d) mine[d] = 0;
    uint first = min(n, run * per_run), end = min(n, first + per_run);
    for (uint i = first; i < end; ++i) mine[digit_of(keys[i], shift, digits)] += 1;
    for (uint d = 0; d < digits; ++d) counts[d * runs + run] = mine[d];
}

// With `number` not 0 the payload of the first pass is the position itself; `payload` is then not read.
kernel void radix_scatter(global const KEY* restrict keys, global const uint* restrict payload, uint n, uint per_run, uint runs,
                          uint shift, uint digits, global const uint* restrict offsets, global KEY* restrict keys_out,
                          global uint* restrict payload_out, uint number) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint next[MAX_DIGITS];
    for (uint d = 0; d < digits; ++d) next[d] = offsets[d * runs + run];
    uint first = min(n, run * per_run), end = min(n, first + per_run);
    // Two loops, so that no compiler reads a payload that is not there.
    if (number != 0) {
        for (uint i = first; i < end; ++i) {
            KEY key = keys[i];
            uint to = next[digit_of(key, shift, digits)]++;
            keys_out[to] = key;
            payload_out[to] = i;
        }
    } else {
        for (uint i = first; i < end; ++i) {
            KEY key = keys[i];
            uint to = next[digit_of(key, shift, digits)]++;
            keys_out[to] = key;
            payload_out[to] = payload[i];
        }
    }
}
