// The incremental path: pairs of fattened boxes are kept, and a step looks again only at what changed.
//
// Kept are: a grid over the fattened boxes (entries in columns, see grid.cl), whose spare entries take the bodies that have
// left their fattened box since it was made; the pairs of fattened boxes at that time (first column a, second column b,
// ascending), each with a state, 1 if the boxes themselves overlap; and for each body where its pairs are. A body that
// stays within its fattened box has its pairs tested again. One that leaves it gets a new fattened box in a spare entry, its
// kept pairs are dead from then on, and its new ones are looked for in the grid: they join the extra pairs, a short
// list. The result is the kept and the extra pairs whose boxes overlap, merged.
// Source: fattened boxes as in the dynamic tree of Box2D [Catto 2019, "Dynamic Bounding Volume Hierarchies"]; states kept
// beside the pairs are ours.
//
//   inc_fatten     boxes -> fattened boxes (rows)
//   inc_places     order of entries -> place[body]
//   inc_split      pairs -> columns a and b, numbers 0, 1, ...
//   inc_first_rows sorted numbers of bodies -> first[body]: where its run begins
//   inc_states     kept pairs, boxes -> states
//   inc_apply      changed bodies and their boxes -> boxes; marks[i]: 1 has left its fattened box, 2 is no box
//   inc_move       bodies that have left: new fattened box in its entry, kept pairs dead
//   inc_query, inc_query_spare   bodies that have left -> pairs of fattened boxes, into a pair sink: with those in the grid,
//                  with those that have left before or now
//   inc_retest     changed bodies -> states of their kept pairs
//   inc_extra      extra pairs -> states
//   inc_count      states -> pairs that each block of kept pairs, with the extra pairs among them, puts out
//   inc_fill       the same, with offsets (the scan of counts) -> pairs
// Defines: LANES, FILTERS; BLOCK (1024): kept pairs of a block, a multiple of LANES; SLICE (1024): spare entries of a task
#include "common/lanes.clh"
#include "common/box.clh"
#include "common/search.clh"
#include "broad_phase/pair_sink.clh"
#include "broad_phase/grid_cells.clh"
#ifndef BLOCK
#define BLOCK 1024
#endif
#ifndef SLICE
#define SLICE 1024
#endif

// `box` grown on all sides by `share` of its longest side, never beyond what a float can say; NaN if it is no box. The grown
// box holds the box: subtracting what is not negative never rounds up.
inline void fatten(global const float* box, float share, GridBox* fat) {
    bool valid = is_box(box);
    float grow = fmax(fmax(box[3] - box[0], box[4] - box[1]), box[5] - box[2]) * share;
    for (uint d = 0; d < 3; ++d) {
        fat->min[d] = valid ? fmax(box[d] - grow, -MAXFLOAT) : NAN;
        fat->max[d] = valid ? fmin(box[d + 3] + grow, MAXFLOAT) : NAN;
    }
}

kernel void inc_fatten(global const float* restrict boxes, ulong first, uint n, float share, global float* restrict fat_boxes) {
    uint i = get_global_id(0);
    if (i >= n) return;
    GridBox fat;
    fatten(boxes + (first + i) * 6, share, &fat);
    for (uint d = 0; d < 3; ++d) {
        fat_boxes[(ulong)i * 6 + d] = fat.min[d];
        fat_boxes[(ulong)i * 6 + d + 3] = fat.max[d];
    }
}

kernel void inc_places(global const uint* restrict order, uint n, global uint* restrict place) {
    uint entry = get_global_id(0);
    if (entry < n) place[order[entry]] = entry;
}

kernel void inc_split(global const uint* restrict pairs, uint count, global uint* restrict a, global uint* restrict b,
                      global uint* restrict keys) {
    uint k = get_global_id(0);
    if (k >= count) return;
    a[k] = pairs[2 * (ulong)k];
    b[k] = pairs[2 * (ulong)k + 1];
    keys[k] = pairs[2 * (ulong)k + 1];
}

// One work-item 256 bodies.
kernel void inc_first_rows(global const uint* restrict sorted, uint count, uint n, global uint* restrict first) {
    uint body = get_global_id(0) * 256;
    first_of_each(sorted, count, body, min(body + 256, n + 1), first);
}

// Touching boxes overlap. Kept and extra pairs are of bodies that have boxes.
inline bool overlap(global const float* boxes, ulong first, uint a, uint b) {
    global const float* p = boxes + (first + a) * 6;
    global const float* q = boxes + (first + b) * 6;
    bool all = true;
    for (uint d = 0; d < 3; ++d) all = all & (p[d] <= q[d + 3]) & (q[d] <= p[d + 3]);
    return all;
}

kernel void inc_states(global const float* restrict boxes, ulong first, global const uint* restrict a, global const uint* restrict b,
                       uint count, global uchar* restrict states) {
    uint k = get_global_id(0);
    if (k < count) states[k] = overlap(boxes, first, a[k], b[k]) ? 1 : 0;
}

// `rows` holds the new boxes of `changed` bodies; with `in_place` the boxes have them already.
kernel void inc_apply(global const uint* restrict changed, uint count, global const float* restrict rows, uint in_place,
                      global float* restrict boxes, ulong first, global const float* restrict columns, ulong stride,
                      global const uint* restrict place, global uint* restrict marks) {
    uint i = get_global_id(0);
    if (i >= count) return;
    uint body = changed[i], entry = place[body];
    global float* box = boxes + (first + body) * 6;
    if (in_place == 0)
        for (uint d = 0; d < 6; ++d) box[d] = rows[(ulong)i * 6 + d];
    bool inside = true;
    for (uint d = 0; d < 3; ++d)
        inside = inside & (columns[d * stride + entry] <= box[d]) & (columns[(d + 3) * stride + entry] >= box[d + 3]);
    bool valid = is_box(box);
    marks[i] = (valid && inside ? 0 : 1) | (valid ? 0 : 2);
}

// leavers: (body, its new entry) of those that have left; entries from `spare` on are spare ones.
// Their new boxes go into columns too, up to leaver_stride of them, with NaN at the end.
kernel void inc_move(global const uint2* restrict leavers, uint count, uint leaver_stride, global float* restrict leaver_columns,
                     global uint* restrict leaver_ids, global const float* restrict boxes, ulong first, float share,
                     uint spare, uint frame, global float* restrict columns, ulong stride, global uint* restrict order,
                     global uint* restrict place, global uint* restrict left, global const uint* restrict first_of_a,
                     global const uint* restrict first_of_b, global const uint* restrict by_b, global uchar* restrict states) {
    uint i = get_global_id(0);
    if (i >= count) {
        for (uint d = 0; d < 6 && i < leaver_stride; ++d) leaver_columns[d * leaver_stride + i] = NAN;
        if (i < leaver_stride) leaver_ids[i] = 0;
        return;
    }
    uint body = leavers[i].x, entry = leavers[i].y, old = place[body];
    if (old < spare) {
        for (uint d = 0; d < 6; ++d) columns[d * stride + old] = NAN;
        for (uint k = first_of_a[body]; k < first_of_a[body + 1]; ++k) states[k] = 0;
        for (uint k = first_of_b[body]; k < first_of_b[body + 1]; ++k) states[by_b[k]] = 0;
    }
    GridBox fat;
    fatten(boxes + (first + body) * 6, share, &fat);
    for (uint d = 0; d < 3; ++d) {
        columns[d * stride + entry] = fat.min[d];
        columns[(d + 3) * stride + entry] = fat.max[d];
        leaver_columns[d * leaver_stride + i] = fat.min[d];
        leaver_columns[(d + 3) * leaver_stride + i] = fat.max[d];
    }
    leaver_ids[i] = body;
    order[entry] = body;
    place[body] = entry;
    left[body] = frame;
}

// One task: one body that has left, against the entries that stay.
kernel void inc_query(global const uint2* restrict leavers, global const float* restrict columns, ulong stride,
                      global const uint* restrict order, global const uint* restrict start, constant GridFrame* g, SINK_PARAMS) {
    PairSink sink = sink_begin(SINK_ARGS);
    Entries e;
    e.columns = columns;
    e.stride = stride;
    e.order = order;
    for (uint task = sink_task(&sink); task < sink.task_end; task = sink_task(&sink)) {
        uint body = leavers[task].x;
        GridBox b = box_at(columns, stride, leavers[task].y);
        if (!(b.min[0] <= b.max[0])) continue;  // no box any more
        walk_cells(&e, start, g, &b, body, 0, 1, &sink);
        test_entries(&e, &b, body, start[g->cells], start[g->cells + 1], &sink);
    }
    sink_end(&sink);
}

// LANES bodies that have left, from number i on, against spare entries [from, to). Of two bodies that left in this frame the
// greater finds the other.
inline void test_spare(global const float* leaver_columns, uint leaver_stride, global const uint* leaver_ids, uint i,
                       global const float* columns, ulong stride, global const uint* order, global const uint* left, uint frame,
                       uint from, uint to, PairSink* sink) {
    global const float* q = leaver_columns + i;
    const floatN min_x = load_lanes(0, q), min_y = load_lanes(0, q + leaver_stride), min_z = load_lanes(0, q + 2 * leaver_stride);
    const floatN max_x = load_lanes(0, q + 3 * leaver_stride), max_y = load_lanes(0, q + 4 * leaver_stride),
                 max_z = load_lanes(0, q + 5 * leaver_stride);
    sink->counts.tests += (ulong)(to - from) * LANES;
    for (uint j = from; j < to; ++j) {
        global const float* p = columns + j;
        uint bits = lane_bits(as_mask((p[0] <= max_x) & (p[stride] <= max_y) & (p[2 * stride] <= max_z) & (p[3 * stride] >= min_x) &
                                      (p[4 * stride] >= min_y) & (p[5 * stride] >= min_z)));
        if (bits == 0) continue;
        uint other = order[j];
        if (left[other] == frame) bits &= lane_bits(as_mask(load_lanes(0, leaver_ids + i) > other));
        sink_put_lanes(sink, leaver_ids + i, bits, other);
    }
}

// Tasks: for each LANES bodies that have left, slices of SLICE spare entries.
kernel void inc_query_spare(global const float* restrict leaver_columns, uint leaver_stride, global const uint* restrict leaver_ids,
                            global const float* restrict columns, ulong stride, global const uint* restrict order,
                            global const uint* restrict left, uint frame, uint spare, uint spare_end, uint slices, SINK_PARAMS) {
    PairSink sink = sink_begin(SINK_ARGS);
    for (uint task = sink_task(&sink); task < sink.task_end; task = sink_task(&sink)) {
        uint group = task / slices, from = spare + (task - group * slices) * SLICE;
        test_spare(leaver_columns, leaver_stride, leaver_ids, group * LANES, columns, stride, order, left, frame, from,
                   min(spare_end, from + SLICE), &sink);
    }
    sink_end(&sink);
}

// A kept pair lives while neither of its bodies has left.
inline void retest(global const float* boxes, ulong first, uint spare, global const uint* place, global const uint* a,
                   global const uint* b, uint k, global uchar* states) {
    if (place[a[k]] < spare && place[b[k]] < spare) states[k] = overlap(boxes, first, a[k], b[k]) ? 1 : 0;
}

kernel void inc_retest(global const uint* restrict changed, uint count, global const float* restrict boxes, ulong first, uint spare,
                       global const uint* restrict place, global const uint* restrict a, global const uint* restrict b,
                       global const uint* restrict first_of_a, global const uint* restrict first_of_b,
                       global const uint* restrict by_b, global uchar* restrict states) {
    uint i = get_global_id(0);
    if (i >= count) return;
    uint body = changed[i];
    if (place[body] >= spare) return;
    for (uint k = first_of_a[body]; k < first_of_a[body + 1]; ++k) retest(boxes, first, spare, place, a, b, k, states);
    for (uint k = first_of_b[body]; k < first_of_b[body + 1]; ++k) retest(boxes, first, spare, place, a, b, by_b[k], states);
}

kernel void inc_extra(global const uint* restrict extra, uint count, global const float* restrict boxes, ulong first,
                      global uint* restrict states) {
    uint k = get_global_id(0);
    if (k < count) states[k] = overlap(boxes, first, extra[2 * (ulong)k], extra[2 * (ulong)k + 1]) ? 1 : 0;
}

inline bool before(uint a, uint b, uint c, uint d) { return a < c || (a == c && b < d); }

// First extra pair that is not before (a, b).
inline uint first_extra(global const uint* extra, uint count, uint a, uint b) {
    uint low = 0, high = count;
    while (low < high) {
        uint middle = low + (high - low) / 2;
        if (before(extra[2 * (ulong)middle], extra[2 * (ulong)middle + 1], a, b))
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

#if LANES == 1
inline uint state_bits(global const uchar* states) { return states[0] != 0 ? 1 : 0; }
#else
inline uint state_bits(global const uchar* states) {
    intN s = CLINCH_JOIN(convert_int, LANES)(load_lanes(0, states));
    return lane_bits(as_mask(s != 0));
}
#endif

// Kept pairs of block number `block`, and the extra pairs that come before its end and not before its start.
inline void block_of(uint block, uint blocks, uint kept, uint extra_count, global const uint* a, global const uint* b,
                     global const uint* extra, uint* range) {
    range[0] = block * BLOCK;
    range[1] = min(kept, range[0] + BLOCK);
    range[2] = block == 0 ? 0 : first_extra(extra, extra_count, a[range[0]], b[range[0]]);
    range[3] = block + 1 == blocks ? extra_count : first_extra(extra, extra_count, a[range[1]], b[range[1]]);
}

kernel void inc_count(global const uint* restrict a, global const uint* restrict b, global const uchar* restrict states, uint kept,
                      global const uint* restrict extra, global const uint* restrict extra_states, uint extra_count, uint blocks,
                      global uint* restrict counts) {
    uint block = get_global_id(0);
    if (block >= blocks) return;
    uint range[4];
    block_of(block, blocks, kept, extra_count, a, b, extra, range);
    uint count = 0;
    for (uint k = range[0]; k < range[1]; k += LANES) count += popcount(state_bits(states + k));
    for (uint e = range[2]; e < range[3]; ++e) count += extra_states[e];
    counts[block] = count;
}

// Kept pairs from k on, before `end` and before the pair (x, y): those with a state to `at` on, which moves on; whole vectors
// are written where there is room up to `room`. Gives the first pair that is not before (x, y).
inline uint put_kept(global const uint* a, global const uint* b, global const uchar* states, uint k, uint end, uint x, uint y,
                     uint* at, uint room, global uint* pairs) {
    uint to = *at;
    while (k < end) {
        uintN va = load_lanes(0, a + k), vb = load_lanes(0, b + k);
        uint earlier = lane_bits(as_mask((va < x) | ((va == x) & (vb < y))));
        if (end - k < LANES) earlier &= (1u << (end - k)) - 1;
        uint bits = state_bits(states + k) & earlier, count = popcount(earlier);
#if COMPRESS
        if (to + LANES <= room) {
            uintN low = compress_lanes(va, bits), high = compress_lanes(vb, bits);
            store_lanes(interleave_low(low, high), 0, pairs + 2 * (ulong)to);
            store_lanes(interleave_high(low, high), 1, pairs + 2 * (ulong)to);
            to += popcount(bits);
            bits = 0;
        }
#endif
        for (; bits != 0; bits &= bits - 1, ++to) {
            uint from = k + lowest_bit(bits);
            pairs[2 * (ulong)to] = a[from];
            pairs[2 * (ulong)to + 1] = b[from];
        }
        k += count;
        if (count < LANES) break;
    }
    *at = to;
    return k;
}

kernel void inc_fill(global const uint* restrict a, global const uint* restrict b, global const uchar* restrict states, uint kept,
                     global const uint* restrict extra, global const uint* restrict extra_states, uint extra_count, uint blocks,
                     global const uint* restrict offsets, global const uint* restrict counts, global uint* restrict pairs) {
    uint block = get_global_id(0);
    if (block >= blocks) return;
    uint range[4];
    block_of(block, blocks, kept, extra_count, a, b, extra, range);
    uint at = offsets[block], room = at + counts[block], k = range[0];
    for (uint e = range[2]; e < range[3]; ++e) {
        if (extra_states[e] == 0) continue;
        uint x = extra[2 * (ulong)e], y = extra[2 * (ulong)e + 1];
        k = put_kept(a, b, states, k, range[1], x, y, &at, room, pairs);
        pairs[2 * (ulong)at] = x;
        pairs[2 * (ulong)at + 1] = y;
        ++at;
    }
    put_kept(a, b, states, k, range[1], 0xffffffffu, 0, &at, room, pairs);
}
