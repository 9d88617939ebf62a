// Sorts pairs (a, b) of uints, ascending by a, then b. First into 256 buckets by the leading bits of a (count, scan,
// scatter, each work-item a run of its own), then each bucket by one work-item: a radix sort from the
// last digit, in the caches, or by insertion where that is shorter.
//
//   pair_count    pairs, n -> counts[bucket * runs + run]
//   pair_scatter  pairs, offsets (the scan of counts) -> pairs by bucket; starts[bucket]
//   pair_buckets  pairs by bucket, starts -> pairs in order, in `even` after an even number of passes, else in `odd`
// Any work-group size. Defines: none
#define BUCKETS 256
#define INSERTION 48  // up to so many pairs insertion is faster

inline uint bucket_of(uint2 pair, uint shift) { return pair.x >> shift; }

kernel void pair_count(global const uint2* restrict pairs, ulong n, ulong per_run, uint runs, uint shift,
                       global uint* restrict counts) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint mine[BUCKETS];
    for (uint d = 0; d < BUCKETS; ++d) mine[d] = 0;
    ulong first = run * per_run, end = min(n, first + per_run);
    for (ulong i = first; i < end; ++i) mine[bucket_of(pairs[i], shift)] += 1;
    for (uint d = 0; d < BUCKETS; ++d) counts[d * runs + run] = mine[d];
}

kernel void pair_scatter(global const uint2* restrict pairs, ulong n, ulong per_run, uint runs, uint shift,
                         global const uint* restrict offsets, global uint2* restrict out) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint next[BUCKETS];
    for (uint d = 0; d < BUCKETS; ++d) next[d] = offsets[d * runs + run];
    ulong first = run * per_run, end = min(n, first + per_run);
    for (ulong i = first; i < end; ++i) {
        uint2 pair = pairs[i];
        out[next[bucket_of(pair, shift)]++] = pair;
    }
}

inline bool before(uint2 p, uint2 q) { return p.x < q.x || (p.x == q.x && p.y < q.y); }

inline void insertion_sort(global uint2* from, global uint2* to, uint n) {
    for (uint i = 0; i < n; ++i) {
        uint2 pair = from[i];
        uint k = i;
        for (; k > 0 && before(pair, to[k - 1]); --k) to[k] = to[k - 1];
        to[k] = pair;
    }
}

// 8 bits from bit `at` on of the key: `b_bits` of b, then a.
inline uint digit_of(uint2 pair, uint at, uint b_bits) {
    ulong key = ((ulong)pair.x << b_bits) | pair.y;
    return (uint)(key >> at) & 255;
}

inline void radix_pass(global const uint2* from, global uint2* to, uint n, uint at, uint b_bits) {
    uint next[256];
    for (uint d = 0; d < 256; ++d) next[d] = 0;
    for (uint i = 0; i < n; ++i) next[digit_of(from[i], at, b_bits)] += 1;
    uint sum = 0;
    for (uint d = 0; d < 256; ++d) {
        uint count = next[d];
        next[d] = sum;
        sum += count;
    }
    for (uint i = 0; i < n; ++i) to[next[digit_of(from[i], at, b_bits)]++] = from[i];
}

kernel void pair_buckets(global uint2* even, global uint2* odd, ulong n, global const uint* restrict offsets, uint runs,
                         uint b_bits, uint key_bits) {
    uint bucket = get_global_id(0);
    if (bucket >= BUCKETS) return;
    uint start = offsets[bucket * runs];
    uint count = (bucket + 1 < BUCKETS ? offsets[(bucket + 1) * runs] : (uint)n) - start;
    global uint2* from = even + start;
    global uint2* to = odd + start;
    uint passes = (key_bits + 7) / 8;
    if (count <= INSERTION) {
        // Ends where the passes would: into the other buffer, and back once more if they are even.
        insertion_sort(from, to, count);
        if (passes % 2 == 0)
            for (uint i = 0; i < count; ++i) from[i] = to[i];
        return;
    }
    for (uint pass = 0; pass < passes; ++pass) {
        radix_pass(from, to, count, pass * 8, b_bits);
        global uint2* swap = from;
        from = to;
        to = swap;
    }
}
