// The incremental path: between steps in which little changes, only what changed is looked at again.
//
// Kept are: the sorted list of the pairs that overlap (kept_list.cl); a grid over the boxes as they were when it was made
// (entries in columns, see grid.cl); and the movers. A body becomes a mover when its box first changes: its entry in the
// grid is wiped out, and it gets a fattened box that holds its own and, for the direction it moves in, some more. All
// boxes that overlap the fattened box are looked for once; with each the mover forms a live pair. As long as the mover
// stays within its fattened box its live pairs are all that can overlap. When it leaves it, its live pairs die and
// it is looked for afresh. So a step tests the live pairs, before and after the step: those that differ are what joins and
// leaves the list.
// Movers stand in a hash table of cells, each cell a chain of nodes: their min corner says which, and the size of a cell is
// twice what a query must look back from it, so that it looks into few cells. Movers too large for that share one chain.
// A mover that leaves gets a new node; old ones are passed over, and when nodes run out all are chained afresh.
// Source: fattened boxes that reach ahead as in the dynamic tree of Box2D [Catto 2019, "Dynamic Bounding Volume
// Hierarchies"]; cells in a hash table [Teschner et al. 2003, "Optimized Spatial Hashing for Collision Detection of
// Deformable Objects"].
//
//   inc_places      order of entries -> place[body]
//   inc_apply       changed bodies and their boxes -> boxes of movers; marks[i]: 1 has left its fattened box or has none,
//                   2 is no box
//   inc_query_old   bodies that were no movers -> pairs that their entries had with others (each twice, and with itself)
//   inc_move        bodies that left -> their movers, with new fattened boxes and nodes; entries wiped out
//   inc_link        movers -> a node for each
//   inc_query, inc_query_movers   bodies that left -> pairs of fattened boxes, into a pair sink: with entries of the grid,
//                   with movers
//   inc_test        live pairs -> states: 1 leaves the list, 2 joins it, 4 is dead and no pair any more
//   inc_begin       new live pairs -> live pairs at their places, and states
// place[body]: its entry if below n, else n + its mover; live pairs are of such numbers too, but have the body itself where
// it is no mover.
// Defines: LANES; FILTERS (0): 1 applies filters before a pair is stored; RUN (1): what a work-item of inc_apply and inc_test takes
#include "common/lanes.clh"
#include "common/box.clh"
#include "broad_phase/pair_sink.clh"
#include "broad_phase/grid_cells.clh"

#ifndef RUN
#define RUN 1
#endif
#if (defined(__SSE__) || defined(__aarch64__)) && CLINCH_HAS(__builtin_prefetch)
#define ask_for(p) __builtin_prefetch(p)
#else
#define ask_for(p)
#endif

#define NONE 0xffffffffu
#define NO_NODE 0u
#define FIRST 1u    // bits of what is told of a body that left: it was no mover,
#define FRESH 2u    // its filters changed,
#define NO_ROW NONE  // its row among the new boxes, if it has one

// As in src/broad_phase/incremental.hpp. Boxes: min x y z, max x y z; all NaN for what is no box. A cache line: what
// tests of pairs read.
typedef struct {
    float now[6], old[6];       // old: before the last step in which the box changed
    uint changed, left, fresh;  // the last step in which it did, in which it got a fattened box, that knew nothing of it
    uint body;
} Mover;

typedef struct {
    float box[6];
    uint node, body;
} Fat;

// As in src/broad_phase/incremental.cpp: the cells of movers.
typedef struct {
    float origin[3];
    float scale;   // cells a unit of length
    float widest;  // of a mover that is in a cell
    float reach;   // a little more: what to look back from a min corner
    uint mask;     // number of chains of cells, a power of two, less 1; the chain behind them is that of large movers
} Cells;

inline void no_box(global float* box) {
    for (uint d = 0; d < 6; ++d) box[d] = NAN;
}
inline void copy_box(global float* to, global const float* from) {
    for (uint d = 0; d < 6; ++d) to[d] = from[d];
}
inline void copy_checked(global float* to, global const float* from) {
    if (is_box(from))
        copy_box(to, from);
    else
        no_box(to);
}
inline bool same_bits(global const float* p, global const float* q, ulong stride) {
    bool same = true;
    for (uint d = 0; d < 6; ++d) same = same & (as_uint(p[d]) == as_uint(q[d * stride]));
    return same;
}

// Touching boxes overlap; what is no box overlaps none.
inline bool overlap(global const float* p, global const float* q) {
    bool all = true;
    for (uint d = 0; d < 3; ++d) all = all & (p[d] <= q[d + 3]) & (q[d] <= p[d + 3]);
    return all;
}

kernel void inc_places(global const uint* restrict order, uint n, global uint* restrict place) {
    uint entry = get_global_id(0);
    if (entry < n) place[order[entry]] = entry;
}

// The new box of body number i of those that changed: its row, or where the boxes have them already its place there.
inline global const float* new_box(global const float* rows, uint in_place, global const float* boxes, ulong first, uint i, uint body) {
    return in_place ? boxes + (first + body) * 6 : rows + (ulong)i * 6;
}

// Brings one body up to date; returns its mark.
inline uint apply(uint at, global const float* box, global const float* columns, ulong stride, uint n, global Mover* movers,
                  global const Fat* fats, uint frame) {
    uint mark = is_box(box) ? 0 : 2;
    if (at < n) return mark | (same_bits(box, columns + at, stride) ? 0 : 1);
    global Mover* m = movers + (at - n);
    copy_box(m->old, m->now);
    copy_checked(m->now, box);
    m->changed = frame;
    global const float* fat = fats[at - n].box;
    bool inside = true;
    for (uint d = 0; d < 3; ++d) inside = inside & (fat[d] <= m->now[d]) & (fat[d + 3] >= m->now[d + 3]);
    return mark | (inside ? 0 : 1);
}

// A work-item takes RUN bodies.
kernel void inc_apply(global const uint* restrict changed, uint count, global const float* restrict rows, uint in_place,
                      global const float* restrict boxes, ulong first, global const float* restrict columns, ulong stride, uint n,
                      global const uint* restrict place, global Mover* restrict movers, global const Fat* restrict fats, uint frame,
                      global uint* restrict marks) {
    uint from = get_global_id(0) * RUN;
    if (from >= count) return;
    uint to = min(count, from + RUN);
#if RUN > 1
    for (uint i = from; i < to; ++i) {
        ask_for(place + changed[i]);
        if (in_place) ask_for(boxes + (first + changed[i]) * 6);
    }
    for (uint i = from; i < to; ++i) {
        uint at = place[changed[i]];
        if (at < n) continue;
        ask_for(movers + (at - n));
        ask_for(fats + (at - n));
    }
#endif
    for (uint i = from; i < to; ++i)
        marks[i] = apply(place[changed[i]], new_box(rows, in_place, boxes, first, i, changed[i]), columns, stride, n, movers, fats, frame);
}

inline void find_entries(const Entries* e, global const uint* start, constant GridFrame* g, const GridBox* b, uint body, PairSink* sink) {
    walk_cells(e, start, g, b, body, 0, 1, sink);
    test_entries(e, b, body, start[g->cells], start[g->cells + 1], sink);  // large ones
}

// Tasks: bodies that leave, here those with FIRST; before inc_move.
kernel void inc_query_old(global const uint4* restrict leavers, global const uint* restrict place, global const float* restrict columns,
                          ulong stride, global const uint* restrict order, global const uint* restrict start, constant GridFrame* g,
                          SINK_PARAMS) {
    PairSink sink = sink_begin(SINK_ARGS);
    Entries e;
    e.columns = columns;
    e.stride = stride;
    e.order = order;
    for (uint task = sink_task(&sink); task < sink.task_end; task = sink_task(&sink)) {
        if ((leavers[task].w & FIRST) == 0) continue;
        uint body = leavers[task].x;
        uint entry = place[body];
        if (entry >= start[g->cells + 1]) continue;  // was no box
        GridBox b = box_at(columns, stride, entry);
        find_entries(&e, start, g, &b, body, &sink);
    }
    sink_end(&sink);
}

// The box grown on all sides by `share` of its longest side, and by `ahead` steps like the last one in that direction, at
// most by `most` of the longest side; never beyond what a float can say. NaN if it is no box. The grown box holds the box:
// adding what is not negative, or subtracting it, never rounds to the other side.
inline void fatten(global const Mover* m, float share, float ahead, float most, global float* fat) {
    global const float* box = m->now;
    float longest = fmax(fmax(box[3] - box[0], box[4] - box[1]), box[5] - box[2]);
    for (uint d = 0; d < 3; ++d) {
        float low = (m->old[d] - box[d]) * ahead, high = (box[d + 3] - m->old[d + 3]) * ahead;  // NaN counts for nothing
        low = longest * share + fmin(fmax(low, 0.0f), longest * most);
        high = longest * share + fmin(fmax(high, 0.0f), longest * most);
        bool valid = box[d] <= box[d + 3];
        fat[d] = valid ? fmax(box[d] - low, -MAXFLOAT) : NAN;
        fat[d + 3] = valid ? fmin(box[d + 3] + high, MAXFLOAT) : NAN;
    }
}

// Grows with the coordinate.
inline int cell_on(float x, uint d, constant Cells* c) {
    return (int)fmin(fmax(floor((x - c->origin[d]) * c->scale), -1.0e9f), 1.0e9f);
}
inline uint chain_of(int x, int y, int z, constant Cells* c) {
    uint h = (uint)x * 73856093u ^ (uint)y * 19349663u ^ (uint)z * 83492791u;
    return (h ^ h >> 15) & c->mask;
}
inline bool is_large(global const float* fat, constant Cells* c) {
    return !(fmax(fmax(fat[3] - fat[0], fat[4] - fat[1]), fat[5] - fat[2]) <= c->widest);
}

// nodes: (mover, next node of the chain), from number 1 on. What is no box stands in no chain.
inline void link(global Fat* f, uint mover, uint node, constant Cells* c, volatile global uint* heads, global uint2* nodes) {
    global const float* fat = f->box;
    f->node = NO_NODE;
    if (!(fat[0] <= fat[3])) return;
    uint chain = is_large(fat, c) ? c->mask + 1 : chain_of(cell_on(fat[0], 0, c), cell_on(fat[1], 1, c), cell_on(fat[2], 2, c), c);
    f->node = node;
    nodes[node].x = mover;
    nodes[node].y = atomic_xchg(heads + chain, node);
}

kernel void inc_link(global Fat* restrict fats, uint count, constant Cells* c, volatile global uint* restrict heads,
                     global uint2* restrict nodes) {
    uint i = get_global_id(0);
    if (i < count) link(fats + i, i, i + 1, c, heads, nodes);
}

// leavers: (body, mover, its number among those that changed or NO_ROW, bits). Their nodes are those from first_node on.
kernel void inc_move(global const uint4* restrict leavers, uint count, global const float* restrict rows, uint in_place,
                     global const float* restrict boxes, ulong first, float share, float ahead, float most, uint n, uint frame,
                     global float* restrict columns, ulong stride, global uint* restrict place, global Mover* restrict movers,
                     global Fat* restrict fats, constant Cells* c, uint first_node, volatile global uint* restrict heads, global uint2* restrict nodes) {
    uint i = get_global_id(0);
    if (i >= count) return;
    uint body = leavers[i].x, mover = leavers[i].y, row = leavers[i].z, bits = leavers[i].w;
    global Mover* m = movers + mover;
    if (bits & FIRST) {
        uint entry = place[body];
        for (uint d = 0; d < 6; ++d) m->now[d] = columns[d * stride + entry];
        copy_checked(m->old, m->now);
        if (row == NO_ROW)
            copy_box(m->now, m->old);
        else
            copy_checked(m->now, new_box(rows, in_place, boxes, first, row, body));
        columns[entry] = NAN;
        place[body] = n + mover;
        m->body = body;
        fats[mover].body = body;
        // Bodies that begin to move together shall not all leave together ever after.
        ahead *= 0.5f + (float)(body * 2654435769u >> 8) * 0x1p-25f;
        m->changed = frame;
    }
    fatten(m, share, ahead, most, fats[mover].box);
    m->left = frame;
    m->fresh = bits != 0 ? frame : 0;
    link(fats + mover, mover, first_node + i, c, heads, nodes);
}

// Tasks: bodies that left.
kernel void inc_query(global const uint4* restrict leavers, global const Fat* restrict fats, global const float* restrict columns,
                      ulong stride, global const uint* restrict order, global const uint* restrict start, constant GridFrame* g,
                      SINK_PARAMS) {
    PairSink sink = sink_begin(SINK_ARGS);
    Entries e;
    e.columns = columns;
    e.stride = stride;
    e.order = order;
    for (uint task = sink_task(&sink); task < sink.task_end; task = sink_task(&sink)) {
        global const Fat* f = fats + leavers[task].y;
        if (!(f->box[0] <= f->box[3])) continue;  // no box any more
        GridBox b;
        for (uint d = 0; d < 3; ++d) {
            b.min[d] = f->box[d];
            b.max[d] = f->box[d + 3];
        }
        find_entries(&e, start, g, &b, f->body, &sink);
    }
    sink_end(&sink);
}

typedef struct {
    global const Fat* fats;
    global const Mover* movers;
    global const uint2* nodes;
    uint frame;
} Fats;

// Of two bodies that left in this step the greater finds the other.
inline void test_mover(global const Fat* f, uint number, const Fats* all, PairSink* sink) {
    global const Fat* other = all->fats + number;
    sink->counts.tests += 1;
    if (!overlap(f->box, other->box)) return;
    if (other->body >= f->body && all->movers[number].left == all->frame) return;
    sink_put(sink, f->body, other->body);
}

inline void test_chain(global const Fat* f, uint node, const Fats* all, PairSink* sink) {
    while (node != NO_NODE) {
        uint2 here = all->nodes[node];
        if (all->fats[here.x].node == node) test_mover(f, here.x, all, sink);
        node = here.y;
    }
}

// Movers of one cell: its chain may have those of others too.
inline void test_cell(global const Fat* f, int x, int y, int z, constant Cells* c, global const uint* heads, const Fats* all,
                      PairSink* sink) {
    for (uint node = heads[chain_of(x, y, z, c)]; node != NO_NODE;) {
        uint2 here = all->nodes[node];
        global const Fat* other = all->fats + here.x;
        if (other->node == node && cell_on(other->box[0], 0, c) == x && cell_on(other->box[1], 1, c) == y && cell_on(other->box[2], 2, c) == z)
            test_mover(f, here.x, all, sink);
        node = here.y;
    }
}

kernel void inc_query_movers(global const uint4* restrict leavers, global const Mover* restrict movers,
                             global const Fat* restrict fats, uint mover_count, constant Cells* c, global const uint* restrict heads, global const uint2* restrict nodes, uint frame,
                             SINK_PARAMS) {
    PairSink sink = sink_begin(SINK_ARGS);
    Fats all;
    all.fats = fats;
    all.movers = movers;
    all.nodes = nodes;
    all.frame = frame;
    for (uint task = sink_task(&sink); task < sink.task_end; task = sink_task(&sink)) {
        global const Fat* f = fats + leavers[task].y;
        if (!(f->box[0] <= f->box[3])) continue;
        int low[3], high[3];
        float cells = 1.0f;
        for (uint d = 0; d < 3; ++d) {
            low[d] = cell_on(f->box[d] - c->reach, d, c);
            high[d] = cell_on(f->box[d + 3], d, c);
            cells *= (float)high[d] - (float)low[d] + 1.0f;
        }
        if (cells > (float)mover_count) {  // a large one: all movers are fewer
            for (uint i = 0; i < mover_count; ++i) test_mover(f, i, &all, &sink);
            continue;
        }
        for (int z = low[2]; z <= high[2]; ++z)
            for (int y = low[1]; y <= high[1]; ++y)
                for (int x = low[0]; x <= high[0]; ++x) test_cell(f, x, y, z, c, heads, &all, &sink);
        test_chain(f, heads[c->mask + 1], &all, &sink);
    }
    sink_end(&sink);
}

// One side of a live pair: its box before and after this step, and what happened to it.
typedef struct {
    global const float *old, *now;
    uint left, fresh;
} Side;

inline void mover_side(global const Mover* m, uint frame, Side* s) {
    s->now = m->now;
    s->old = m->changed == frame ? m->old : m->now;
    s->left = m->left == frame ? 1 : 0;
    s->fresh = m->fresh == frame ? 1 : 0;
}

inline void side_of(uint number, uint n, global const float* boxes, ulong first, global const Mover* movers, uint frame, Side* s) {
    if (number >= n) {
        mover_side(movers + (number - n), frame, s);
        return;
    }
    s->old = s->now = boxes + (first + number) * 6;
    s->left = s->fresh = 0;
}

// A pair of which one side is fresh leaves and joins if it can: the host cancels what does both.
inline uint difference(const Side* p, const Side* q) {
    uint before = overlap(p->old, q->old) ? 1 : 0, after = overlap(p->now, q->now) ? 1 : 0, fresh = p->fresh | q->fresh;
    return (before & ((after ^ 1) | fresh)) | (after & ((before ^ 1) | fresh)) << 1;
}

// State of a live pair; dead ones and empty places are emptied.
inline uint test_live(global uint2* live, uint any_first, global const uint* place, uint n, global const float* boxes, ulong first,
                      global const Mover* movers, uint frame) {
    uint2 pair = *live;
    if (pair.x == NONE) return 0;
    if (any_first && pair.y < n && place[pair.y] >= n) pair.y = place[pair.y];
    Side p, q;
    mover_side(movers + (pair.x - n), frame, &p);
    side_of(pair.y, n, boxes, first, movers, frame, &q);
    uint state = difference(&p, &q);
    if (p.left | q.left) {
        state = (state & 1) | 4;
        live->x = live->y = NONE;
    }
    return state;
}

// With `any_first`, bodies have become movers in this step. The first side of a live pair is a mover.
// A work-item takes RUN pairs. Boxes lie all over memory: on a CPU all of a run are asked for at first.
kernel void inc_test(global uint2* restrict live, uint count, uint any_first, global const uint* restrict place, uint n,
                     global const float* restrict boxes, ulong first, global const Mover* restrict movers, uint frame,
                     global uchar* restrict states) {
    uint from = get_global_id(0) * RUN;
    if (from >= count) return;
    uint to = min(count, from + RUN);
#if RUN > 1
    for (uint k = from; k < to; ++k) {
        uint2 pair = live[k];
        if (pair.y < n) ask_for(boxes + (first + pair.y) * 6);
        if (pair.x != NONE) ask_for(movers[pair.x - n].now);
    }
#endif
    for (uint k = from; k < to; ++k) states[k] = test_live(live + k, any_first, place, n, boxes, first, movers, frame);
}

// begun: (place among the live pairs, the two sides)
kernel void inc_begin(global const uint4* restrict begun, uint count, uint n, global const float* restrict boxes, ulong first,
                      global const Mover* restrict movers, uint frame, global uint2* restrict live, global uchar* restrict states) {
    uint i = get_global_id(0);
    if (i >= count) return;
    uint4 pair = begun[i];
    Side p, q;
    mover_side(movers + (pair.y - n), frame, &p);
    side_of(pair.z, n, boxes, first, movers, frame, &q);
    live[pair.x].x = pair.y;
    live[pair.x].y = pair.z;
    states[pair.x] = difference(&p, &q) & 2;
}
