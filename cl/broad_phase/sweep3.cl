// Three-axis sweep: the thesis' topological broad phase [thesis 4.1]. The bounds of all boxes are sorted on each axis;
// between the two bounds of a body lie the lower bounds of those that begin while it lasts, which gives the overlaps
// of each axis as pairs of body numbers; pairs common to the three axes are the result. Kept as the
// baseline that other algorithms are measured by.
// Changed: the thesis looks for each pair of one axis in the whole lists of the others. Here the list of the axis with
// the fewest overlaps is sorted, and each overlap of the other axes is looked up in it, in the row of its lower
// body number by halving.
// The lists are worked through in batches, the pairs whose lower body number is in [s0, s1), so that memory is bounded.
// Of a batch, S are the bodies in [s0, s1) and T all from s0 on: a body of S is paired with those of T that begin
// behind it while it lasts, another one of T with those of S; each pair of the batch comes up once on every axis.
//
//   sweep3_bounds   boxes (rows, from box `first` on), axis -> keys[2 n]: lower bounds, then upper bounds, as integers of the
//                   same order; all ones for what is no box. Sorted stably: of equal bounds the lower come first
//   sweep3_starts   sorted keys, payload -> starts[p]: 1 where entry p is the lower bound of a box, else 0
//   sweep3_ranks    payload, starts, scan of starts -> order[rank]: bodies by lower bound; last[body]: rank behind the last
//                   one that begins while the body lasts
//   sweep3_members  order, m (boxes), s0, s1 -> in_t, in_s: 1 where the body of a rank is in T, in S; m + 1 entries
//   sweep3_lists    order, scans t and s of those -> t_list, s_list: bodies of T and of S by rank
//   sweep3_count    order, last, t, s -> before[rank]: overlaps of the ranks before in its run; run_counts[run] (64-bit)
//   sweep3_fill     overlaps number 0 to `count` - 1 of an axis -> keys (a - s0) << b_bits | b
//   sweep3_rows     sorted keys -> row[a - s0]: first of them whose lower body number is a or higher; s1 - s0 + 1 entries
//   sweep3_mark     the overlaps of another axis; where the key of one is in sorted `keys`, marks of that place + 1
//   sweep3_keep     keys, marks -> keep: 1 where the marks are 2 and the filters let the pair pass; two counts a run
//   sweep3_pairs    keys, keep, scan of keep -> pairs in order
// Any work-group size. Defines: FILTERS (0): 1 applies group, mask and motion
#include "common/box.clh"
#include "common/ordered.clh"

#ifndef FILTERS
#define FILTERS 0
#endif

#define NO_BOX 0xffffffffu

kernel void sweep3_bounds(global const float* restrict boxes, ulong first, uint n, uint axis, global uint* restrict keys) {
    uint i = get_global_id(0);
    if (i >= n) return;
    global const float* box = boxes + (first + i) * 6;
    bool valid = is_box(box);
    for (uint side = 0; side < 2; ++side) {
        float bound = box[axis + 3 * side];
        keys[i + side * n] = valid ? ordered(bound == 0.0f ? 0.0f : bound) : NO_BOX;  // -0 touches 0
    }
}

kernel void sweep3_starts(global const uint* restrict keys, global const uint* restrict payload, uint n, global uint* restrict starts) {
    uint p = get_global_id(0);
    if (p < 2 * n) starts[p] = payload[p] < n && keys[p] != NO_BOX ? 1 : 0;
}

kernel void sweep3_ranks(global const uint* restrict payload, global const uint* restrict starts, global const uint* restrict rank, uint n,
                         global uint* restrict order, global uint* restrict last) {
    uint p = get_global_id(0);
    if (p >= 2 * n) return;
    uint bound = payload[p];
    if (bound >= n)
        last[bound - n] = rank[p];
    else if (starts[p] != 0)
        order[rank[p]] = bound;
}

kernel void sweep3_members(global const uint* restrict order, uint m, uint s0, uint s1, global uint* restrict in_t, global uint* restrict in_s) {
    uint r = get_global_id(0);
    if (r > m) return;
    uint body = r < m ? order[r] : 0;
    in_t[r] = r < m && body >= s0 ? 1 : 0;
    in_s[r] = r < m && body >= s0 && body < s1 ? 1 : 0;
}

kernel void sweep3_lists(global const uint* restrict order, uint m, uint s0, uint s1, global const uint* restrict t, global const uint* restrict s,
                         global uint* restrict t_list, global uint* restrict s_list) {
    uint r = get_global_id(0);
    if (r >= m) return;
    uint body = order[r];
    if (body >= s0) t_list[t[r]] = body;
    if (body >= s0 && body < s1) s_list[s[r]] = body;
}

kernel void sweep3_count(global const uint* restrict order, global const uint* restrict last, uint m, uint s0, uint s1,
                         global const uint* restrict t, global const uint* restrict s, uint per_run, uint runs, global ulong* restrict before,
                         global ulong* restrict run_counts) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint first = run * per_run, end = m - first > per_run ? first + per_run : m;
    ulong sum = 0;
    for (uint r = first; r < end; ++r) {
        uint body = order[r];
        before[r] = sum;
        if (body >= s0) sum += body < s1 ? t[last[body]] - t[r + 1] : s[last[body]] - s[r + 1];
    }
    run_counts[run] = sum;
}

// The last of the `count` ascending values, the first of which is not above `number`, that is not above it.
inline uint last_not_above(global const ulong* values, uint count, ulong number) {
    uint low = 0, high = count;
    while (high - low > 1) {
        uint middle = low + (high - low) / 2;
        if (values[middle] <= number)
            low = middle;
        else
            high = middle;
    }
    return low;
}

// Overlaps of one axis by number; each work-item goes through `piece` of the `count` there are.
#define OVERLAP_PARAMS                                                                                                \
    global const uint *order, global const uint *last, global const uint *t, global const uint *s, global const uint *t_list, \
        global const uint *s_list, global const ulong *before, global const ulong *run_start, uint m, uint s0, uint s1,   \
        uint per_run, uint runs, ulong count, uint piece, uint b_bits

// Body of overlap `number`, and the partner with which it is that.
#define OVERLAP_FIND(number, body, partners, partners_end)                               \
    {                                                                                    \
        uint run_ = last_not_above(run_start, runs, number);                             \
        uint first_ = run_ * per_run;                                                    \
        ulong in_run_ = (number) - run_start[run_];                                      \
        uint r_ = first_ + last_not_above(before + first_, min(per_run, m - first_), in_run_); \
        body = order[r_];                                                                \
        bool from_s_ = body < s1;                                                        \
        global const uint* scan_ = from_s_ ? t : s;                                      \
        global const uint* list_ = from_s_ ? t_list : s_list;                            \
        partners = list_ + scan_[r_ + 1] + (uint)(in_run_ - before[r_]);                 \
        partners_end = list_ + scan_[last[body]];                                        \
    }

inline ulong pair_key(uint i, uint j, uint s0, uint b_bits) { return ((ulong)(min(i, j) - s0) << b_bits) | max(i, j); }

kernel void sweep3_fill(OVERLAP_PARAMS, global ulong* restrict keys) {
    ulong number = (ulong)get_global_id(0) * piece, stop = min(count, number + piece);
    uint body = 0;
    global const uint *partner = t_list, *end = t_list;
    for (; number < stop; ++number) {
        if (partner == end) OVERLAP_FIND(number, body, partner, end)
        keys[number] = pair_key(body, *partner++, s0, b_bits);
    }
}

kernel void sweep3_rows(global const ulong* restrict keys, uint count, uint rows, uint b_bits, global uint* restrict row) {
    uint a = get_global_id(0);
    if (a > rows) return;
    uint low = 0, high = count;
    while (low < high) {
        uint middle = low + (high - low) / 2;
        if (keys[middle] >> b_bits < a)
            low = middle + 1;
        else
            high = middle;
    }
    row[a] = low;
}

kernel void sweep3_mark(OVERLAP_PARAMS, global const ulong* restrict keys, global const uint* restrict row, global uint* restrict marks) {
    ulong number = (ulong)get_global_id(0) * piece, stop = min(count, number + piece);
    uint body = 0;
    global const uint *partner = t_list, *end = t_list;
    for (; number < stop; ++number) {
        if (partner == end) OVERLAP_FIND(number, body, partner, end)
        ulong key = pair_key(body, *partner++, s0, b_bits);
        uint a = (uint)(key >> b_bits), row_start = row[a], row_size = row[a + 1] - row_start;
        if (row_size == 0) continue;
        uint place = row_start + last_not_above(keys + row_start, row_size, key);
        if (keys[place] == key) marks[place] += 1;  // no other overlap of this axis has the same key
    }
}

kernel void sweep3_keep(global const ulong* restrict keys, uint count, uint s0, uint b_bits, uint per_run, uint runs,
                        global const uint4* restrict filters, global uint* restrict marks, global ulong* restrict run_counts) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint first = run * per_run, end = count - first > per_run ? first + per_run : count;
    ulong filtered = 0, unmoving = 0;
    for (uint k = first; k < end; ++k) {
        uint keep = marks[k] == 2 ? 1 : 0;
#if FILTERS
        if (keep != 0) {
            uint4 f = filters[(uint)(keys[k] >> b_bits) + s0], g = filters[(uint)(keys[k] & ((1ul << b_bits) - 1))];
            bool allowed = (f.x & g.y) != 0 && (g.x & f.y) != 0, moves = (f.z | g.z) != 0;
            filtered += allowed ? 0 : 1;
            unmoving += allowed && !moves ? 1 : 0;
            keep = allowed && moves ? 1 : 0;
        }
#endif
        marks[k] = keep;
    }
    run_counts[2 * run] = filtered;
    run_counts[2 * run + 1] = unmoving;
}

kernel void sweep3_pairs(global const ulong* restrict keys, uint count, uint s0, uint b_bits, global const uint* restrict keep,
                         global const uint* restrict place, global uint* restrict pairs) {
    uint k = get_global_id(0);
    if (k >= count || keep[k] == 0) return;
    pairs[2 * (ulong)place[k]] = (uint)(keys[k] >> b_bits) + s0;
    pairs[2 * (ulong)place[k] + 1] = (uint)(keys[k] & ((1ul << b_bits) - 1));
}
