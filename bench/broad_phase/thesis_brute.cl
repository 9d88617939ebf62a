// The thesis' brute force as it stands [3.1.2, 4.2], kept as the baseline: one pair a work-item, its number
// decoded by the quadratic formula, the result one bit set by an atomic. The one change: the root is
// corrected by integer steps, since without that it tests wrong pairs.
//
//   thesis_brute  boxes (Aabb rows), n -> bits (bit k % 32 of word k / 32 is pair number k; cleared by the caller)
//   thesis_count  bits -> number of bits set, added to `total`; one work-item a run of words
// Defines: none
#include "common/pair_index.clh"

kernel void thesis_brute(global const float* restrict boxes, uint n, global uint* restrict bits) {
    ulong k = get_global_id(0);
    if (k >= (ulong)n * (n - 1) / 2) return;
    uint a, b;
    decode_pair(k, n, &a, &b);
    global const float* p = boxes + (ulong)a * 6;
    global const float* q = boxes + (ulong)b * 6;
    if (p[0] <= q[3] && p[1] <= q[4] && p[2] <= q[5] && q[0] <= p[3] && q[1] <= p[4] && q[2] <= p[5])
        atomic_or((volatile global uint*)bits + k / 32, 1u << (k % 32));
}

kernel void thesis_count(global const uint* restrict bits, uint words, uint per_item, global uint* restrict total) {
    uint first = get_global_id(0) * per_item;
    uint end = min(words, first + per_item);
    uint sum = 0;
    for (uint w = first; w < end; ++w) sum += popcount(bits[w]);
    if (sum != 0) atomic_add((volatile global uint*)total, sum);
}
