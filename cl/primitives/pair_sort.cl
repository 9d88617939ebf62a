// Sorts pairs (a, b) of uints, ascending by a, then b. First into buckets by the leading bits of a (count, scan,
// scatter, each work-item a run of its own). On the way a pair is packed into a key of what its bucket does not tell
// already: the lower bits of a, then b; in 32 bits where they fit. Then each bucket by one work-item, in the caches:
// a radix sort of its keys from the last digit, or by insertion where that is shorter. Last the keys are unpacked.
// Source: radix sort from the first digit down to parts that fit a cache, then from the last one [Rahman and Raman:
// Adapting radix sort to the memory hierarchy, 2001]; writes gathered into cache lines [Satish et al.: Fast sort on
// CPUs and GPUs, SIGMOD 2010].
//
//   pair_count    pairs, n -> counts[bucket * runs + run]
//   pair_scatter  pairs, offsets (the scan of counts) -> keys by bucket
//   pair_buckets  keys by bucket, offsets -> pairs in order; uses up the keys
//   key_buckets   the same, but the keys stay packed, in order where they are; uses up the pairs. And
//                 starts[bucket], where each begins
// `shift` is the number of bits of a below those that name the bucket, b_bits the number of bits of b.
// Any work-group size.
// Defines: LANES (given by the library for the device); KEY (uint): uint, where shift + b_bits is at most 32, or ulong;
//   MAX_BUCKETS (256); DIGIT_BITS (8): most bits of a digit
#include "common/lanes.clh"

#ifndef KEY
#define KEY uint
#endif
#ifndef MAX_BUCKETS
#define MAX_BUCKETS 256
#endif
#ifndef DIGIT_BITS
#define DIGIT_BITS 8
#endif
#define MAX_DIGITS (1u << DIGIT_BITS)
#define INSERTION 32                     // up to so many keys insertion is faster
#define FEW 1024                         // fewer keys than this want short digits
#define LINE ((uint)(64 / sizeof(KEY)))  // keys of a cache line

kernel void pair_count(global const uint2* restrict pairs, ulong n, ulong per_run, uint runs, uint buckets, uint shift,
                       global uint* restrict counts) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint mine[MAX_BUCKETS];
    for (uint d = 0; d < buckets; ++d) mine[d] = 0;
    ulong first = run * per_run, end = min(n, first + per_run);
    for (ulong i = first; i < end; ++i) mine[pairs[i].x >> shift] += 1;
    for (uint d = 0; d < buckets; ++d) counts[d * runs + run] = mine[d];
}

inline uint low_bits(uint bits) { return bits < 32 ? (1u << bits) - 1 : 0xffffffffu; }
inline KEY key_of(uint2 pair, uint shift, uint b_bits) {
    return ((KEY)(pair.x & low_bits(shift)) << b_bits) | pair.y;
}

#if LANES == 1
kernel void pair_scatter(global const uint2* restrict pairs, ulong n, ulong per_run, uint runs, uint buckets,
                         uint shift, uint b_bits, global const uint* restrict offsets, global KEY* restrict out) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint next[MAX_BUCKETS];
    for (uint d = 0; d < buckets; ++d) next[d] = offsets[d * runs + run];
    ulong first = run * per_run, end = min(n, first + per_run);
    for (ulong i = first; i < end; ++i) {
        uint2 pair = pairs[i];
        out[next[pair.x >> shift]++] = key_of(pair, shift, b_bits);
    }
}
#else
// A whole line, past the caches where there is an instruction for it: it is read again only when all are written.
inline void write_line(const KEY* line, global KEY* to) {
#if CLINCH_HAS(__builtin_nontemporal_store)
    __builtin_nontemporal_store(*(const uint16*)line, (global uint16*)to);
#else
    *(global uint16*)to = *(const uint16*)line;
#endif
}

// A CPU writes whole cache lines best. A bucket's keys wait in a line of its own, of private memory, until the key
// behind it comes (reading the line right after its last key would wait for that key). Lines are aligned in `out`;
// the first and the last of a run in a bucket, which others may share, are written key by key.
kernel void pair_scatter(global const uint2* restrict pairs, ulong n, ulong per_run, uint runs, uint buckets,
                         uint shift, uint b_bits, global const uint* restrict offsets, global KEY* restrict out) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    KEY lines[MAX_BUCKETS * LINE] __attribute__((aligned(64)));
    uint next[MAX_BUCKETS];
    for (uint d = 0; d < buckets; ++d) next[d] = offsets[d * runs + run];
    ulong first = run * per_run, end = min(n, first + per_run);
    for (ulong i = first; i < end; ++i) {
        uint2 pair = pairs[i];
        uint bucket = pair.x >> shift;
        uint to = next[bucket]++;
        KEY* line = lines + bucket * LINE;
        if (to % LINE == 0) {
            uint start = offsets[bucket * runs + run];
            if (to - start >= LINE)
                write_line(line, out + (to - LINE));
            else
                for (uint k = start; k < to; ++k) out[k] = line[k % LINE];
        }
        line[to % LINE] = key_of(pair, shift, b_bits);
    }
    for (uint d = 0; d < buckets; ++d) {
        uint to = next[d], start = offsets[d * runs + run];
        if (to == start) continue;
        for (uint k = max(start, to - 1 - (to - 1) % LINE); k < to; ++k) out[k] = lines[d * LINE + k % LINE];
    }
}
#endif

inline void insertion_sort(global KEY* keys, uint n) {
    for (uint i = 1; i < n; ++i) {
        KEY key = keys[i];
        uint k = i;
        for (; k > 0 && key < keys[k - 1]; --k) keys[k] = keys[k - 1];
        keys[k] = key;
    }
}

// Sorts n keys of `here`, with room for as many in `there`, by digits of `width` bits; returns which of them holds
// the result. A digit that all keys share is passed over.
inline global KEY* radix_sort(global KEY* here, global KEY* there, uint n, uint key_bits, uint width) {
    uint next[MAX_DIGITS];
    uint digits = 1u << width, mask = digits - 1;
    for (uint at = 0; at < key_bits; at += width) {
        for (uint d = 0; d < digits; ++d) next[d] = 0;
        for (uint i = 0; i < n; ++i) next[(uint)(here[i] >> at) & mask] += 1;
        if (next[(uint)(here[0] >> at) & mask] == n) continue;
        uint sum = 0;
        for (uint d = 0; d < digits; ++d) {
            uint count = next[d];
            next[d] = sum;
            sum += count;
        }
        for (uint i = 0; i < n; ++i) {
            KEY key = here[i];
            there[next[(uint)(key >> at) & mask]++] = key;
        }
        global KEY* swap = here;
        here = there;
        there = swap;
    }
    return here;
}

#define EIGHT_OF(type) EIGHT_OF_(type)
#define EIGHT_OF_(type) type##8

// Writes the pairs of n keys of a bucket that begins at body a. `keys` may lie at the end of the room of `out`: what is
// written from its beginning on, 8 pairs at a time, never reaches a key that is still to be read.
inline void unpack(global const KEY* keys, uint n, uint a, uint shift, uint b_bits, global uint2* out) {
    uint a_mask = low_bits(shift), b_mask = low_bits(b_bits), i = 0;
#if LANES > 1
    for (; i + 8 <= n; i += 8) {
        EIGHT_OF(KEY) key = vload8(0, keys + i);
        uint8 u = a | (convert_uint8(key >> b_bits) & a_mask), v = convert_uint8(key & b_mask);
        vstore16((uint16)(u.s0, v.s0, u.s1, v.s1, u.s2, v.s2, u.s3, v.s3, u.s4, v.s4, u.s5, v.s5, u.s6, v.s6, u.s7, v.s7),
                 0, (global uint*)(out + i));
    }
#endif
    for (; i < n; ++i) out[i] = (uint2)(a | ((uint)(keys[i] >> b_bits) & a_mask), (uint)keys[i] & b_mask);
}

// Sorts n keys of a bucket; returns where they are then: where they were, or at the end of the room of the bucket's
// pairs, which were all read and serve as the other half of the work.
inline global KEY* sort_bucket(global KEY* keys, uint n, global uint2* pairs, uint key_bits) {
    if (n <= INSERTION) {
        insertion_sort(keys, n);
        return keys;
    }
    uint most = n < FEW ? 8 : DIGIT_BITS, passes = (key_bits + most - 1) / most;
    return radix_sort(keys, (global KEY*)(pairs + n) - n, n, key_bits, (key_bits + passes - 1) / passes);
}

inline uint end_of(uint bucket, ulong n, global const uint* offsets, uint runs, uint buckets) {
    return bucket + 1 < buckets ? offsets[(bucket + 1) * runs] : (uint)n;
}

kernel void pair_buckets(global KEY* keys, global uint2* pairs, ulong n, global const uint* restrict offsets, uint runs,
                         uint buckets, uint shift, uint b_bits) {
    uint bucket = get_global_id(0);
    if (bucket >= buckets) return;
    uint start = offsets[bucket * runs], count = end_of(bucket, n, offsets, runs, buckets) - start;
    global KEY* sorted = sort_bucket(keys + start, count, pairs + start, shift + b_bits);
    unpack(sorted, count, bucket << shift, shift, b_bits, pairs + start);
}

kernel void key_buckets(global KEY* keys, global uint2* pairs, ulong n, global const uint* restrict offsets, uint runs,
                        uint buckets, uint shift, uint b_bits, global uint* restrict starts) {
    uint bucket = get_global_id(0);
    if (bucket >= buckets) return;
    uint start = offsets[bucket * runs], count = end_of(bucket, n, offsets, runs, buckets) - start;
    starts[bucket] = start;
    global KEY* sorted = sort_bucket(keys + start, count, pairs + start, shift + b_bits);
    if (sorted == keys + start) return;
    for (uint i = 0; i < count; ++i) keys[start + i] = sorted[i];
}
