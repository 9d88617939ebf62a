// Sweep: boxes sorted by their min on one axis; each is tested against those behind it that begin before it ends.
// Source: sweep and prune [Baraff 1992; thesis 1.3.1.4] on one axis, chosen by the variance of the centres [Ericson,
// Real-Time Collision Detection, 7.5.2]; ranges, scan, flat numbers of work as in [Le Grand 2007] and MuJoCo Warp.
// Each pair once: it is found by the box that comes first in the order of the axis.
// A long box stalls nobody: a box's work is 1 turn for itself and 1 for every LANES boxes in its range; turns are
// numbered through all boxes, and a task is a piece of these numbers, wherever in a box it begins and ends.
//
//   sweep_statistics  boxes (rows, from box `first` on), n, per_run -> 16 uints a run: boxes that are boxes; then
//                     floats: shift[3] (a centre), of (centre - shift) sum[3] and sum of squares[3], lowest min[3],
//                     highest max[3]
//   sweep_keys        boxes, axis -> keys: min on the axis as integers of the same order, all ones for what is no box
//   sweep_gather      boxes, order (payload of the sorted keys), the first m of them boxes -> columns in that order: min and
//                     max on the axis, on the next one, on the one after that; NaN from m on
//   sweep_ranges      columns, m, per_run -> end[i]: first box behind i that begins after i ends; before[i]: turns of the
//                     boxes before i in its run; run_turns[run]. Turns are 64-bit: their sum may pass 2^32
//   sweep_pairs       columns, order, end, before, run_start (the scan of run_turns), piece (turns a task) -> pairs
// Any work-group size. Defines: LANES, FILTERS (0)
#include "common/lanes.clh"
#include "common/box.clh"
#include "common/ordered.clh"
#include "broad_phase/pair_sink.clh"

kernel void sweep_statistics(global const float* restrict boxes, ulong first, uint n, uint per_run, uint runs,
                             global uint* restrict records) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    float shift[3] = {0.0f, 0.0f, 0.0f}, sum[3] = {0.0f, 0.0f, 0.0f}, square[3] = {0.0f, 0.0f, 0.0f};
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    uint count = 0;
    ulong begin = first + (ulong)run * per_run, end = first + min((ulong)n, (ulong)(run + 1) * per_run);
    for (ulong i = begin; i < end; ++i) {
        global const float* box = boxes + i * 6;
        if (!is_box(box)) continue;
        for (uint d = 0; d < 3; ++d) {
            float centre = 0.5f * box[d] + 0.5f * box[d + 3];
            if (count == 0) shift[d] = centre;
            float x = centre - shift[d];
            sum[d] += x;
            square[d] += x * x;
            low[d] = fmin(low[d], box[d]);
            high[d] = fmax(high[d], box[d + 3]);
        }
        ++count;
    }
    global uint* record = records + run * 16;
    record[0] = count;
    for (uint d = 0; d < 3; ++d) {
        record[1 + d] = as_uint(shift[d]);
        record[4 + d] = as_uint(sum[d]);
        record[7 + d] = as_uint(square[d]);
        record[10 + d] = as_uint(low[d]);
        record[13 + d] = as_uint(high[d]);
    }
}

kernel void sweep_keys(global const float* restrict boxes, ulong first, uint n, uint axis, global uint* restrict keys) {
    uint i = get_global_id(0);
    if (i >= n) return;
    global const float* box = boxes + (first + i) * 6;
    keys[i] = is_box(box) ? ordered(box[axis]) : 0xffffffffu;
}

kernel void sweep_gather(global const float* restrict boxes, ulong first, global const uint* restrict order, uint m, uint stride,
                         uint axis, global float* restrict columns) {
    uint i = get_global_id(0);
    if (i >= stride) return;
    global const float* box = boxes + (first + (i < m ? order[i] : 0)) * 6;
    for (uint k = 0; k < 3; ++k) {
        uint d = (axis + k) % 3;
        columns[2 * k * (ulong)stride + i] = i < m ? box[d] : NAN;
        columns[(2 * k + 1) * (ulong)stride + i] = i < m ? box[d + 3] : NAN;
    }
}

// First of the boxes [from, m) whose min is above `value`; sought in growing steps, then by halving.
inline uint first_above(global const float* mins, uint from, uint m, float value) {
    uint low = from, high = from, step = 1;
    while (high < m && mins[high] <= value) {
        low = high + 1;
        high = m - high > step ? high + step : m;
        step *= 2;
    }
    while (low < high) {
        uint middle = low + (high - low) / 2;
        if (mins[middle] <= value)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

// Turns of box i, whose range ends at `end`.
inline uint turns_of(uint i, uint end) { return 1 + (end - i - 1) / LANES + ((end - i - 1) % LANES != 0 ? 1 : 0); }

kernel void sweep_ranges(global const float* restrict columns, ulong stride, uint m, uint per_run, uint runs,
                         global uint* restrict ends, global ulong* restrict before, global ulong* restrict run_turns) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint first = run * per_run, end = m - first > per_run ? first + per_run : m;
    ulong turns = 0;
    for (uint i = first; i < end; ++i) {
        uint range_end = first_above(columns, i + 1, m, columns[stride + i]);
        ends[i] = range_end;
        before[i] = turns;
        turns += turns_of(i, range_end);
    }
    run_turns[run] = turns;
}

// The last of the `count` ascending values, the first of which is not above `turn`, that is not above it.
inline uint last_not_above(global const ulong* values, uint count, ulong turn) {
    uint low = 0, high = count;
    while (high - low > 1) {
        uint middle = low + (high - low) / 2;
        if (values[middle] <= turn)
            low = middle;
        else
            high = middle;
    }
    return low;
}

// Boxes [from, to) against box i; on the sorted axis they overlap it.
inline void sweep_test(global const float* columns, ulong stride, global const uint* order, uint i, uint from, uint to,
                       PairSink* sink) {
    const floatN min_u = columns[2 * stride + i], max_u = columns[3 * stride + i];
    const floatN min_v = columns[4 * stride + i], max_v = columns[5 * stride + i];
    uint id = order[i];
    for (uint j = from; j < to; j += LANES) {
        global const float* p = columns + j;
        uint bits = lane_bits(as_mask((load_lanes(0, p + 2 * stride) <= max_u) & (load_lanes(0, p + 3 * stride) >= min_u) &
                                      (load_lanes(0, p + 4 * stride) <= max_v) & (load_lanes(0, p + 5 * stride) >= min_v)));
        if (to - j < LANES) bits &= (1u << (to - j)) - 1;
        for (; bits != 0; bits &= bits - 1) sink_put(sink, id, order[j + lowest_bit(bits)]);
    }
    sink->counts.tests += to - from;
}

kernel void sweep_pairs(global const float* restrict columns, ulong stride, uint m, global const uint* restrict order,
                        global const uint* restrict ends, global const ulong* restrict before, uint per_run, uint runs,
                        global const ulong* restrict run_start, ulong piece, SINK_PARAMS) {
    PairSink sink = sink_begin(SINK_ARGS);
    for (uint task = sink_task(&sink); task < sink.task_end; task = sink_task(&sink)) {
        ulong turn = task * piece, left = piece;
        uint run = last_not_above(run_start, runs, turn);
        turn -= run_start[run];
        uint first = run * per_run;
        uint i = first + last_not_above(before + first, min(per_run, m - first), turn);
        uint skip = (uint)(turn - before[i]);  // turns of box i that belong to the piece before
        for (; left > 0 && i < m; ++i, skip = 0) {
            uint end = ends[i], turns = turns_of(i, end);
            uint stop = (uint)min((ulong)turns, skip + left);
            left -= stop - skip;
            uint from = i + 1 + (skip > 0 ? skip - 1 : 0) * LANES;
            uint to = stop < turns ? i + 1 + (stop - 1) * LANES : end;
            sweep_test(columns, stride, order, i, from, to, &sink);
        }
    }
    sink_end(&sink);
}
