// Grid [thesis 4.2.6]: boxes binned by their min corner into cells, one entry a box; a box is tested against the
// boxes in the cells that its own box can reach. Large boxes, which would force large cells on all, are kept
// apart and walk through the cells they cover.
//
// Which cells: a box overlaps box i only if its min corner lies, on each axis, between min_i - widest and max_i, where
// `widest` is the longest side of any small box. Cell numbers grow with the coordinate however it is rounded, so the
// cells between those of the two ends hold all of them: no proof about cell boundaries is needed.
// Each pair once: of two small boxes the one with the lower min z (ties: the earlier entry) finds the other. So the cells
// of an axis are looked through from min_z_i on only, and there is nothing to remove afterwards.
// LANES entries that follow one another, which are near one another, are looked for at once: they share the window and
// each entry in it is tested against all of them (on a GPU LANES is 1 and the hardware does likewise).
// Empty space costs nothing: when the world has more cells than is worth while, cell numbers wrap around (power of two
// on that axis), so that far apart cells share a number and the box test tells them apart.
//
//   grid_keys    boxes (rows) -> key: cell, or `cells` for a large box, or `cells` + 1 for what is no box
//   grid_gather  boxes, order (payload of the sorted keys) -> columns in that order, padded with NaN
//   grid_starts  sorted keys -> start[c]: first entry with a key >= c, for c up to cells + 2
//   grid_small   small against small    grid_large  large against small    grid_giants  large against large
// Defines: LANES, FILTERS; ENTRIES (16): small entries a task of grid_small, a multiple of LANES
#include "common/lanes.clh"
#include "common/box.clh"
#include "common/search.clh"
#include "broad_phase/pair_sink.clh"
#include "broad_phase/grid_cells.clh"
#ifndef ENTRIES
#define ENTRIES 16
#endif

kernel void grid_keys(global const float* restrict boxes, ulong first, uint n, constant GridFrame* g, global uint* restrict keys) {
    uint i = get_global_id(0);
    if (i >= n) return;
    global const float* b = boxes + (first + i) * 6;
    bool valid = is_box(b);
    uint key = valid ? g->cells : g->cells + 1;
    if (valid && fmax(fmax(b[3] - b[0], b[4] - b[1]), b[5] - b[2]) <= g->widest)
        key = (wrapped(cell_of(b[2], 2, g), 2, g) * g->size[1] + wrapped(cell_of(b[1], 1, g), 1, g)) * g->size[0] +
              wrapped(cell_of(b[0], 0, g), 0, g);
    keys[i] = key;
}

kernel void grid_gather(global const float* restrict boxes, ulong first, global const uint* restrict order, uint n, uint stride,
                        global float* restrict columns) {
    uint i = get_global_id(0);
    if (i >= stride) return;
    global const float* box = boxes + (first + (i < n ? order[i] : 0)) * 6;
    for (uint d = 0; d < 6; ++d) columns[d * (ulong)stride + i] = i < n ? box[d] : NAN;
}

// One work-item 256 cells.
kernel void grid_starts(global const uint* restrict keys, uint n, uint cells, global uint* restrict start) {
    uint c = get_global_id(0) * 256;
    first_of_each(keys, n, c, min(c + 256, cells + 3), start);
}

// LANES small boxes that are looked for at once, entry i and those after it.
typedef struct {
    floatN min_x, min_y, max_x, max_y;
    intN above, end;  // a box is found if its min z, as a key, is at or above `above`, and not above `end`
    uint i;
} Query;

// Grows with the coordinate, one key for both zeros.
inline int z_key(float z) {
    int bits = as_int(z + 0.0f);
    return bits ^ ((bits >> 31) & 0x7fffffff);
}
inline intN z_keys(floatN z) {
    intN bits = as_intN(z + 0.0f);
    return bits ^ ((bits >> 31) & 0x7fffffff);
}

// Small entries [from, to) against the query boxes: found are those whose z key is at or above `above`.
inline void test_run(const Entries* e, const Query* q, intN above, uint from, uint to, PairSink* sink) {
    const floatN min_x = q->min_x, min_y = q->min_y, max_x = q->max_x, max_y = q->max_y;
    const intN end = q->end;
    const ulong stride = e->stride;
    global const uint* ids = e->order + q->i;
    for (uint j = from; j < to; ++j) {
        global const float* p = e->columns + j;
        int z = z_key(p[2 * stride]);
        uint bits = lane_bits(as_mask((p[0] <= max_x) & (p[stride] <= max_y) & (p[3 * stride] >= min_x) & (p[4 * stride] >= min_y) &
                                      (above <= z) & (end >= z)));
        if (bits != 0) sink_put_lanes(sink, ids, bits, e->order[j]);
    }
}

// A query box finds the small entries of a greater z key, and of those of the same key the later ones.
inline void test_queries(const Entries* e, const Query* q, uint from, uint to, PairSink* sink) {
    sink->counts.tests += (ulong)(to - from) * LANES;
    const intN above = q->above;
    uint j = min(to, max(from, q->i));
    test_run(e, q, above + 1, from, j, sink);
    for (; j < q->i + LANES && j < to; ++j)  // j - q->i query boxes stand before entry j
        test_run(e, q, above + as_intN(as_mask(lane_numbers >= j - q->i) & 1u), j, j + 1, sink);
    test_run(e, q, above, j, to, sink);
}

// All small entries in the cells of the window between `low` and `high`, against query boxes.
inline void test_window(const Entries* e, global const uint* start, constant GridFrame* g, const Query* q, const GridBox* window,
                        PairSink* sink) {
    CellRange x = cells_between(window->min[0] - g->reach, window->max[0], 0, g);
    CellRange y = cells_between(window->min[1] - g->reach, window->max[1], 1, g);
    CellRange z = cells_between(window->min[2], window->max[2], 2, g);
    for (uint zk = 0, zc = z.low; zk < z.count; ++zk, zc = next_cell(zc, 2, g))
        for (uint yk = 0, yc = y.low; yk < y.count; ++yk, yc = next_cell(yc, 1, g)) {
            uint first = (zc * g->size[1] + yc) * g->size[0];
            uint end = x.low + x.count;
            test_queries(e, q, start[first + x.low], start[first + min(end, g->size[0])], sink);
            if (end > g->size[0])  // wrapped around
                test_queries(e, q, start[first], start[first + end - g->size[0]], sink);
        }
}

// Entries i to i + LANES, of which bits of `lanes` are set, against all small entries they can reach.
inline void search(const Entries* e, global const uint* start, constant GridFrame* g, uint i, uint lanes, PairSink* sink) {
    const ulong stride = e->stride;
    global const float* p = e->columns + i;
    const floatN min_x = load_lanes(0, p), min_y = load_lanes(0, p + stride), min_z = load_lanes(0, p + 2 * stride);
    const floatN max_x = load_lanes(0, p + 3 * stride), max_y = load_lanes(0, p + 4 * stride), max_z = load_lanes(0, p + 5 * stride);
    Query q;
    q.min_x = min_x;
    q.min_y = min_y;
    q.max_x = max_x;
    q.max_y = max_y;
    q.above = z_keys(min_z);
    q.i = i;
    while (lanes != 0) {
        // Together go those near the first one left: one window is then not much larger than each of theirs.
        global const float* leader = p + lowest_bit(lanes);
        const float x = leader[0], y = leader[stride], z = leader[2 * stride];
        uint near = lanes & lane_bits(as_mask((fabs(min_x - x) <= g->span) & (fabs(min_y - y) <= g->side) & (fabs(min_z - z) <= g->side)));
        near |= lanes & (0u - lanes);
        lanes &= ~near;
        const intN member = as_intN(as_mask((((uintN)(near) >> lane_numbers) & 1u) != 0u));
        const floatN none = INFINITY;
        GridBox window;
        window.min[0] = lowest_lane(select(none, min_x, member));
        window.min[1] = lowest_lane(select(none, min_y, member));
        window.min[2] = lowest_lane(select(none, min_z, member));
        window.max[0] = highest_lane(select(-none, max_x, member));
        window.max[1] = highest_lane(select(-none, max_y, member));
        window.max[2] = highest_lane(select(-none, max_z, member));
        q.end = select((intN)(INT_MIN), z_keys(max_z), member);
        test_window(e, start, g, &q, &window, sink);
    }
}

// One task: ENTRIES small entries.
kernel void grid_small(global const float* restrict columns, ulong stride, global const uint* restrict order,
                       global const uint* restrict start, constant GridFrame* g, SINK_PARAMS) {
    PairSink sink = sink_begin(SINK_ARGS);
    Entries e;
    e.columns = columns;
    e.stride = stride;
    e.order = order;
    uint small = start[g->cells];
    for (uint task = sink_task(&sink); task < sink.task_end; task = sink_task(&sink)) {
        for (uint i = task * ENTRIES, end = min(small, (task + 1) * ENTRIES); i < end; i += LANES)
            search(&e, start, g, i, end - i < LANES ? (1u << (end - i)) - 1 : (uint)ALL_LANES, &sink);
    }
    sink_end(&sink);
}

// Tasks: PARTS for each large box, every PARTS-th layer of cells.
#define PARTS 8

kernel void grid_large(global const float* restrict columns, ulong stride, global const uint* restrict order,
                       global const uint* restrict start, constant GridFrame* g, SINK_PARAMS) {
    PairSink sink = sink_begin(SINK_ARGS);
    Entries e;
    e.columns = columns;
    e.stride = stride;
    e.order = order;
    uint large = start[g->cells];
    for (uint task = sink_task(&sink); task < sink.task_end; task = sink_task(&sink)) {
        uint i = large + task / PARTS;
        GridBox b = box_at(columns, stride, i);
        walk_cells(&e, start, g, &b, order[i], task & (PARTS - 1), PARTS, &sink);
    }
    sink_end(&sink);
}

// One task: one large box against those after it.
kernel void grid_giants(global const float* restrict columns, ulong stride, global const uint* restrict order,
                        global const uint* restrict start, uint cells, SINK_PARAMS) {
    PairSink sink = sink_begin(SINK_ARGS);
    Entries e;
    e.columns = columns;
    e.stride = stride;
    e.order = order;
    uint large = start[cells], end = start[cells + 1];
    for (uint task = sink_task(&sink); task < sink.task_end; task = sink_task(&sink)) {
        uint i = large + task;
        GridBox b = box_at(columns, stride, i);
        test_entries(&e, &b, order[i], i + 1, end, &sink);
    }
    sink_end(&sink);
}
