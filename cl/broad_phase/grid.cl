// Grid [thesis 4.2.6]: boxes binned by their min corner into cells, one entry a box; a box is tested against the
// boxes in the cells that its own box can reach. Large boxes, which would force large cells on all, are kept
// apart and walk through the cells they cover.
//
// Which cells: a box overlaps box i only if its min corner lies, on each axis, between min_i - widest and max_i, where
// `widest` is the longest side of any small box. Cell numbers grow with the coordinate however it is rounded, so the
// cells between those of the two ends hold all of them: no proof about cell boundaries is needed.
// Each pair once: of two small boxes the one with the lower min z (ties: the earlier entry) finds the other. So the cells
// of an axis are looked through from min_z_i on only, and there is nothing to remove afterwards.
// Empty space costs nothing: when the world has more cells than is worth while, cell numbers wrap around (power of two
// on that axis), so that far apart cells share a number and the box test tells them apart.
//
//   grid_keys    boxes (rows) -> key: cell, or `cells` for a large box, or `cells` + 1 for what is no box
//   grid_gather  boxes, order (payload of the sorted keys) -> columns in that order, padded with NaN
//   grid_starts  sorted keys -> start[c]: first entry with a key >= c, for c up to cells + 2
//   grid_small   small against small    grid_large  large against small    grid_giants  large against large
// Defines: LANES, FILTERS
#include "common/lanes.clh"
#include "common/box.clh"
#include "broad_phase/pair_sink.clh"

// As GridFrame in src/broad_phase/grid.cpp.
typedef struct {
    float origin[3];
    float scale[3];   // cells a unit of length
    uint size[3];     // cells on an axis
    uint wrap[3];     // 1: cell numbers wrap around; size is a power of two then
    uint cells;
    float widest;     // of a small box
    float reach;      // a little more: what to look back from a min corner
} GridFrame;

// Unwrapped cell number of a coordinate; grows with it. Beyond the grid's ends it is clamped to them.
inline int cell_of(float x, uint d, constant GridFrame* g) {
    float c = (x - g->origin[d]) * g->scale[d];
    return (int)fmin(fmax(c, 0.0f), 1073741824.0f);
}

inline uint wrapped(int c, uint d, constant GridFrame* g) { return g->wrap[d] ? (uint)c & (g->size[d] - 1) : (uint)c; }

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

// First entry at or after `from` whose key is not below `c`.
inline uint first_at_least(global const uint* keys, uint n, uint from, uint c) {
    uint step = 1, low = from, high = from;
    while (high < n && keys[high] < c) {  // in growing steps past it
        low = high + 1;
        high = high + step < n ? high + step : n;
        step *= 2;
    }
    while (low < high) {
        uint middle = low + (high - low) / 2;
        if (keys[middle] < c)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

// One work-item 256 cells.
kernel void grid_starts(global const uint* restrict keys, uint n, uint cells, global uint* restrict start) {
    uint c = get_global_id(0) * 256;
    uint at = 0;
    for (uint end = min(c + 256, cells + 3); c < end; ++c) {
        at = first_at_least(keys, n, at, c);
        start[c] = at;
    }
}

typedef struct {
    float min[3], max[3];
} GridBox;

// Cells on one axis, from `low` on, `count` of them, after wrapping.
typedef struct {
    uint low, count;
} CellRange;

inline CellRange cells_between(float from, float to, uint d, constant GridFrame* g) {
    int a = cell_of(from, d, g), b = cell_of(to, d, g);
    CellRange r;
    if (g->wrap[d]) {
        r.low = (uint)a & (g->size[d] - 1);
        r.count = min((uint)(b - a + 1), g->size[d]);
    } else {
        a = min(a, (int)g->size[d] - 1);
        b = min(b, (int)g->size[d] - 1);
        r.low = (uint)a;
        r.count = (uint)(b - a + 1);
    }
    return r;
}

inline uint next_cell(uint c, uint d, constant GridFrame* g) { return c + 1 == g->size[d] ? 0 : c + 1; }

inline GridBox box_at(global const float* columns, ulong stride, uint i) {
    GridBox b;
    for (uint d = 0; d < 3; ++d) {
        b.min[d] = columns[d * stride + i];
        b.max[d] = columns[(d + 3) * stride + i];
    }
    return b;
}

// Entries [from, to) against box i. With `forward` only those whose min z is above the box's, or equal and
// later in order.
inline void test_run(global const float* columns, ulong stride, global const uint* order, const GridBox* b, uint i, uint id,
                     uint from, uint to, bool forward, PairSink* sink) {
    const floatN min_x = b->min[0], min_y = b->min[1], max_x = b->max[0], max_y = b->max[1], max_z = b->max[2];
    const floatN min_z = b->min[2];
    sink->counts.tests += to - from;
    for (uint j = from; j < to; j += LANES) {
        global const float* p = columns + j;
        // A box found forward begins at or above this one, so it ends above it too.
        floatN above = load_lanes(0, p + (forward ? 2 : 5) * stride);
        uintN m = as_mask((load_lanes(0, p) <= max_x) & (load_lanes(0, p + stride) <= max_y) & (load_lanes(0, p + 2 * stride) <= max_z) &
                          (load_lanes(0, p + 3 * stride) >= min_x) & (load_lanes(0, p + 4 * stride) >= min_y) & (above >= min_z));
        uint bits = lane_bits(m);
        if (to - j < LANES) bits &= (1u << (to - j)) - 1;
        for (; bits != 0; bits &= bits - 1) {
            uint k = j + lowest_bit(bits);
            if (forward && k <= i && columns[2 * stride + k] == b->min[2]) continue;
            sink_put(sink, id, order[k]);
        }
    }
}

// All entries in the given cells of one row (y, z) against box i.
inline void test_row(global const float* columns, ulong stride, global const uint* order, global const uint* start, constant GridFrame* g,
                     uint row, CellRange x, const GridBox* b, uint i, uint id, bool forward, PairSink* sink) {
    uint first = row * g->size[0];
    uint end = x.low + x.count;
    test_run(columns, stride, order, b, i, id, start[first + x.low], start[first + min(end, g->size[0])], forward, sink);
    if (end > g->size[0])  // wrapped around
        test_run(columns, stride, order, b, i, id, start[first], start[first + end - g->size[0]], forward, sink);
}

// All rows of cells that box i can reach, of the layers z.low + first, + step, ... of z.
inline void test_rows(global const float* columns, ulong stride, global const uint* order, global const uint* start,
                      constant GridFrame* g, uint i, bool forward, uint first, uint step, PairSink* sink) {
    GridBox b = box_at(columns, stride, i);
    CellRange x = cells_between(b.min[0] - g->reach, b.max[0], 0, g);
    CellRange y = cells_between(b.min[1] - g->reach, b.max[1], 1, g);
    CellRange z = cells_between(forward ? b.min[2] : b.min[2] - g->reach, b.max[2], 2, g);
    uint id = order[i];
    for (uint zk = first; zk < z.count; zk += step) {
        uint zc = z.low + zk;
        if (zc >= g->size[2]) zc -= g->size[2];
        for (uint yk = 0, yc = y.low; yk < y.count; ++yk, yc = next_cell(yc, 1, g))
            test_row(columns, stride, order, start, g, zc * g->size[1] + yc, x, &b, i, id, forward, sink);
    }
}

// One task: 16 entries.
#define ENTRIES 16

kernel void grid_small(global const float* restrict columns, ulong stride, global const uint* restrict order,
                       global const uint* restrict start, constant GridFrame* g, SINK_PARAMS) {
    PairSink sink = sink_begin(SINK_ARGS);
    uint small = start[g->cells];
    for (uint task = sink_task(&sink); task < sink.task_end; task = sink_task(&sink)) {
        for (uint i = task * ENTRIES, end = min(small, (task + 1) * ENTRIES); i < end; ++i)
            test_rows(columns, stride, order, start, g, i, true, 0, 1, &sink);
    }
    sink_end(&sink);
}

// Tasks: PARTS for each large box, every PARTS-th layer of cells.
#define PARTS 8

kernel void grid_large(global const float* restrict columns, ulong stride, global const uint* restrict order,
                       global const uint* restrict start, constant GridFrame* g, SINK_PARAMS) {
    PairSink sink = sink_begin(SINK_ARGS);
    uint large = start[g->cells];
    for (uint task = sink_task(&sink); task < sink.task_end; task = sink_task(&sink))
        test_rows(columns, stride, order, start, g, large + task / PARTS, false, task & (PARTS - 1), PARTS, &sink);
    sink_end(&sink);
}

// One task: one large box against those after it.
kernel void grid_giants(global const float* restrict columns, ulong stride, global const uint* restrict order,
                        global const uint* restrict start, uint cells, SINK_PARAMS) {
    PairSink sink = sink_begin(SINK_ARGS);
    uint large = start[cells], end = start[cells + 1];
    for (uint task = sink_task(&sink); task < sink.task_end; task = sink_task(&sink)) {
        uint i = large + task;
        GridBox b = box_at(columns, stride, i);
        test_run(columns, stride, order, &b, i, order[i], i + 1, end, false, &sink);
    }
    sink_end(&sink);
}
