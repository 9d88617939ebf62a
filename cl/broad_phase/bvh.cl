// Bounding volume hierarchy: boxes in the order of a curve through space [Lauterbach 2009], and above them a tree without
// pointers. The curve is Hilbert's, whose neighbours in order are neighbours in space (packed R-tree: Kamel and
// Faloutsos 1993); blocks of it need a third fewer box tests than blocks of Morton's curve do.
//
// The tree is implicit and complete: the boxes in order are cut into blocks of WIDTH; node c of level 1 is the
// box around block c, the nodes of level 1 are cut into blocks again, and so on up to one block. A block is stored as
// columns (WIDTH min x, WIDTH min y, ... WIDTH max z), so that one box is tested against a whole block by vectors. That
// stands in for the binary radix tree of Karras 2012 and Apetrei 2014: a level needs only the level below it (no
// fence across work-groups), n alone tells how many nodes and levels there are (no pointer, no stack that could overflow),
// and a tree whose boxes moved a little is refitted by the passes that built it. Codes are cut off where finer ones
// would not change the blocks much, and boxes far larger than most come behind all others (the size in the code:
// Vinkler 2017), so that they do not widen the nodes of small ones; order is a matter of speed alone.
//
// Queries are blocks, not boxes: block q looks for blocks j >= q that its own box overlaps (half traversal, as in ArborX),
// so each pair is found once. With lanes, the boxes in those blocks that reach the box around q are packed together
// and tested as whole vectors; without, two blocks are compared box by box from the side where fewer boxes reach
// the other block's box.
// The state of a traversal is one word of bits a level: the nodes of the current blocks still to visit.
// A tree may hold some of the boxes only. Where many bodies cannot move, they have a tree of their own, which is kept
// while their boxes stay as they are and is searched against the tree of the others alone: full traversal, as blocks
// of two trees are never the same (static and dynamic trees: Bullet's btDbvtBroadphase).
//
//   bvh_compare boxes of some bodies -> whether they are those of the last call, which are kept
//   bvh_keys    boxes (rows) -> key: class of size, then place of the centre on the curve
//   bvh_crowded sorted keys -> how many blocks lie in one cell, as where finer cells are needed
//   bvh_leaves  boxes, order (payload of the sorted keys) -> blocks of boxes, and level 1
//   bvh_names   order -> names of the boxes in it, for boxes that have others than their numbers
//   bvh_level   one level from the one below
//               both: -> measures (one a work-item): the size of nodes, and whether there is a box that is no box
//   bvh_search  tree, order, the tree to look into (the same or another), its order -> pairs
// What is no box has its corners exchanged, at infinity: it overlaps nothing and adds nothing to a node.
// Defines: LANES, FILTERS; WIDTH (LANES, at least 8): boxes a block; KEY (uint): type of a key, uint or ulong;
// WINDOW (0): blocks that a task may look at where loops end early (see most_loop_iterations), 0: all
#include "common/lanes.clh"
#if LANES > 1
#define SINK_IDS private
#endif
#include "broad_phase/pair_sink.clh"
#include "common/hilbert.clh"

#ifndef WIDTH
#if LANES < 8
#define WIDTH 8
#else
#define WIDTH LANES
#endif
#endif
#ifndef KEY
#define KEY uint
#endif
#ifndef WINDOW
#define WINDOW 0
#endif
#define STEPS (WIDTH / LANES)  // vectors a column of a block
#define BLOCK (6 * WIDTH)      // floats a block
#define MOST_LEVELS 12

// As BvhFrame in src/broad_phase/bvh_tree.cpp.
typedef struct {
    float origin[3];
    float scale;          // cells a unit of length, the same on all axes
    float most_cells;     // the last cell of an axis
    float size_limit[3];  // width that a box of class 0, 1, 2 has at most
    uint class_shift;     // bits of a place on the curve, three times those of an axis
    uint most_class;      // the last class
    float measure;        // what widths of nodes are multiplied with before they are summed
} BvhFrame;

// As BvhLevels there. Blocks of level l begin at block first[l]; level 0 is the boxes; `top` is one block.
typedef struct {
    uint top;
    uint first[MOST_LEVELS];
    uint blocks;  // of level 0
} BvhLevels;

// As BvhMeasure there.
typedef struct {
    float size;    // sum over nodes of the cube of their width
    uint invalid;  // 1: there is a box that is no box
} BvhMeasure;

#if LANES == 1
#define store_floats(v, i, p) ((p)[i] = (v))
#define choose_lanes(mask, yes, no) ((mask) != 0 ? (yes) : (no))
#define truncate_lanes(v) ((uint)(v))
#else
#define store_floats(v, i, p) store_lanes(v, i, p)
#define choose_lanes(mask, yes, no) select(no, yes, mask)
#define truncate_lanes(v) CLINCH_JOIN(convert_uint, LANES)(v)
#define as_floatN(v) CLINCH_JOIN(as_float, LANES)(v)
#define as_uintN(v) CLINCH_JOIN(as_uint, LANES)(v)
#endif

// Asks for memory that is read soon, where a CPU has an instruction for it.
#if (defined(__x86_64__) || defined(__aarch64__)) && CLINCH_HAS(__builtin_prefetch)
#define ask_for(p) __builtin_prefetch((const void*)(size_t)(p))
#else
#define ask_for(p)
#endif

// Row `box` becomes entry `l` of columns of `width`. One by one: of a loop compilers make a scatter, which takes longer.
inline void put_row(float* columns, uint width, uint l, global const float* box) {
    columns[l] = box[0];
    columns[width + l] = box[1];
    columns[2 * width + l] = box[2];
    columns[3 * width + l] = box[3];
    columns[4 * width + l] = box[4];
    columns[5 * width + l] = box[5];
}

// Cells of centres on axis d.
inline uintN cells_of(const float* columns, uint d, constant BvhFrame* f) {
    floatN centre = 0.5f * load_lanes(d, columns) + 0.5f * load_lanes(d + 3, columns);
    return truncate_lanes(fmin(fmax((centre - f->origin[d]) * f->scale, (floatN)(0.0f)), (floatN)(f->most_cells)));
}

// 0, 1, 2 or 3: the class of a box's width, its longest side.
inline uintN size_classes(const float* columns, constant BvhFrame* f) {
    floatN width = fmax(fmax(load_lanes(3, columns) - load_lanes(0, columns), load_lanes(4, columns) - load_lanes(1, columns)),
                        load_lanes(5, columns) - load_lanes(2, columns));
    uintN size = (as_mask(width > f->size_limit[0]) & 1u) + (as_mask(width > f->size_limit[1]) & 1u) +
                 (as_mask(width > f->size_limit[2]) & 1u);
    return min(size, (uintN)(f->most_class));
}

// Work-item i compares bodies [i per_item, (i + 1) per_item) of `bodies`: whether a box, as three pairs of floats, is
// another one than in the last call, to the bit. Keeps the boxes; with `fresh` none were kept before.
kernel void bvh_compare(global const ulong* restrict boxes, ulong first, global const uint* restrict bodies, uint count,
                        uint per_item, uint items, uint fresh, global ulong* restrict kept, global uint* restrict changed) {
    uint item = get_global_id(0);
    if (item >= items) return;
    uint differs = fresh;
    for (uint i = min((ulong)count, item * (ulong)per_item), end = min((ulong)count, i + (ulong)per_item); i < end; ++i) {
        global const ulong* box = boxes + (first + bodies[i]) * 3;
        global ulong* last = kept + i * (ulong)3;
        ulong x = box[0], y = box[1], z = box[2];
        if (!fresh && ((x ^ last[0]) | (y ^ last[1]) | (z ^ last[2])) == 0) continue;
        differs = 1;
        last[0] = x;
        last[1] = y;
        last[2] = z;
    }
    changed[item] = differs;
}

kernel void bvh_names(global const uint* restrict order, global const uint* restrict names, uint n,
                      global uint* restrict out) {
    uint i = get_global_id(0);
    if (i < n) out[i] = names[order[i]];
}

// Work-item i owns boxes [i LANES, (i + 1) LANES) of those whose numbers are in `order`, or of all if not `listed`.
kernel void bvh_keys(global const float* restrict boxes, ulong first, uint n, constant BvhFrame* f,
                     global const uint* restrict order, uint listed, global KEY* restrict keys) {
    uint at = get_global_id(0) * LANES;
    if (at >= n) return;
    float columns[6 * LANES] __attribute__((aligned(64)));
    for (uint l = 0; l < LANES; ++l) {
        uint i = min(at + l, n - 1);
        put_row(columns, LANES, l, boxes + (first + (listed ? order[i] : i)) * 6);
    }
    uintN x = cells_of(columns, 0, f), y = cells_of(columns, 1, f), z = cells_of(columns, 2, f);
    along_hilbert(f->class_shift / 3, &x, &y, &z);
    uint low[LANES], middle[LANES], high[LANES], size[LANES];
    store_lanes(interleave(x, y, z, 0), 0, low);
    store_lanes(interleave(x, y, z, 10), 0, middle);
    store_lanes(interleave(x, y, z, 20), 0, high);
    store_lanes(size_classes(columns, f), 0, size);
    for (uint l = 0; l < LANES && at + l < n; ++l) {
        ulong code = low[l] | (ulong)middle[l] << 30 | (ulong)high[l] << 60;
        keys[at + l] = (KEY)((ulong)size[l] << f->class_shift | code);
    }
}

// Work-item i counts, of blocks [i per_item, (i + 1) per_item) of sorted keys, those whose keys are all the same.
kernel void bvh_crowded(global const KEY* restrict keys, uint blocks, uint per_item, uint items, global uint* restrict crowded) {
    uint item = get_global_id(0);
    if (item >= items) return;
    uint count = 0;
    for (uint c = item * per_item, end = min(blocks, c + per_item); c < end; ++c)
        count += keys[c * WIDTH] == keys[c * WIDTH + WIDTH - 1] ? 1 : 0;
    crowded[item] = count;
}

// Writes node `node` of the level at block `level_first`: the box around a block, which may be null for padding.
// Returns what it adds to the measure.
inline float write_node(global float* tree, uint level_first, uint node, global const float* block, float scale) {
    global float* at = tree + (level_first + node / WIDTH) * (ulong)BLOCK + node % WIDTH;
    float width = 0.0f;
    for (uint d = 0; d < 3; ++d) {
        float low = INFINITY, high = -INFINITY;
        for (uint s = 0; s < STEPS && block; ++s) {
            low = fmin(low, lowest_lane(load_lanes(s, block + d * WIDTH)));
            high = fmax(high, highest_lane(load_lanes(s, block + (d + 3) * WIDTH)));
        }
        at[d * WIDTH] = low;
        at[(d + 3) * WIDTH] = high;
        width += (high - low) * scale;
    }
    return width > 0.0f ? width * width * width : 0.0f;
}

// Stores boxes, given as columns, as a block; returns 1 if one of the first `count` is no box.
inline uint write_block(global float* block, const float* boxes, uint count) {
    uint invalid = 0;
    for (uint s = 0; s < STEPS; ++s) {
        floatN c[6];
        for (uint d = 0; d < 6; ++d) c[d] = load_lanes(s, boxes + d * WIDTH);
        uintN valid = ~(uintN)(0u);
        for (uint d = 0; d < 3; ++d)
            valid &= as_mask((c[d] <= c[d + 3]) & (fabs(c[d]) < (floatN)(INFINITY)) & (fabs(c[d + 3]) < (floatN)(INFINITY)));
        for (uint d = 0; d < 6; ++d)
            store_floats(choose_lanes(valid, c[d], (floatN)(d < 3 ? INFINITY : -INFINITY)), s, block + d * WIDTH);
        uint here = count <= s * LANES ? 0 : count - s * LANES >= LANES ? ALL_LANES : (1u << (count - s * LANES)) - 1;
        invalid |= ~lane_bits(valid) & here;
    }
    return invalid != 0 ? 1 : 0;
}

// Work-item i owns nodes [i per_item, (i + 1) per_item) of level 1, `nodes` in all, padding included.
kernel void bvh_leaves(global const float* restrict boxes, ulong first, global const uint* restrict order, uint n,
                       constant BvhFrame* f, uint blocks, uint level_first, uint nodes, uint per_item, uint items,
                       global float* restrict tree, uint first_measure, global BvhMeasure* restrict measures) {
    uint item = get_global_id(0);
    if (item >= items) return;
    BvhMeasure m = {0.0f, 0};
    boxes += first * 6;
    for (uint c = item * per_item, end = min(nodes, c + per_item); c < end; ++c) {
        global float* block = c < blocks ? tree + c * (ulong)BLOCK : 0;
        if (block) {
            float columns[BLOCK] __attribute__((aligned(64)));
            uint count = min((uint)WIDTH, n - c * WIDTH);
            // The next rows are asked for first: they lie anywhere.
            for (uint l = 0; l < WIDTH && c + 2 < blocks; ++l) ask_for(boxes + order[(c + 1) * WIDTH + l] * (ulong)6);
            for (uint l = 0; l < WIDTH; ++l) {
                // What is behind the last box is one that is no box.
                put_row(columns, WIDTH, l, boxes + order[c * WIDTH + min(l, count - 1)] * (ulong)6);
                if (l >= count) columns[l] = NAN;
            }
            m.invalid |= write_block(block, columns, count);
        }
        m.size += write_node(tree, level_first, c, block, f->measure);
    }
    measures[first_measure + item] = m;
}

// Work-item i owns nodes [i per_item, (i + 1) per_item) of the level at block `level_first`, `nodes` in all, padding
// included, of the level below at `below_first` with `below_blocks` blocks.
kernel void bvh_level(constant BvhFrame* f, uint below_first, uint below_blocks, uint level_first, uint nodes, uint per_item,
                      uint items, global float* tree, uint first_measure, global BvhMeasure* restrict measures) {
    uint item = get_global_id(0);
    if (item >= items) return;
    BvhMeasure m = {0.0f, 0};
    for (uint c = item * per_item, end = min(nodes, c + per_item); c < end; ++c) {
        global const float* block = c < below_blocks ? tree + (below_first + c) * (ulong)BLOCK : 0;
        m.size += write_node(tree, level_first, c, block, f->measure);
    }
    measures[first_measure + item] = m;
}

typedef struct {
    float min_x, min_y, min_z, max_x, max_y, max_z;
} BvhBox;

inline BvhBox box_in(global const float* block, uint l) {
    BvhBox b = {block[l],             block[WIDTH + l],     block[2 * WIDTH + l],
                block[3 * WIDTH + l], block[4 * WIDTH + l], block[5 * WIDTH + l]};
    return b;
}

// Pairs are wanted whose overlap begins on an axis in [low, high): of a slab of space, whose other pairs are another
// device's.
typedef struct {
    uint axis;
    float low, high;
    bool all;  // those of the block in search, whatever it meets
} Range;

// (Not returned: see clinch_bounds.)
inline void set_range(Range* range, uint axis, float low, float high, const BvhBox* around) {
    float first = axis == 0 ? around->min_x : axis == 1 ? around->min_y : around->min_z;
    float last = axis == 0 ? around->max_x : axis == 1 ? around->max_y : around->max_z;
    range->axis = axis;
    range->low = low;
    range->high = high;
    range->all = first >= low && last < high;
}

// Of LANES boxes that begin at `begins` on the axis, those whose pairs with one that begins at `begin` are wanted, as
// bits.
inline uint lanes_in_range(const Range* range, floatN begins, float begin) {
    floatN both = fmax(begins, (floatN)begin);
    return lane_bits(as_mask((both >= (floatN)range->low) & (both < (floatN)range->high)));
}

// Of LANES boxes of a block, those that overlap *b, as bits.
inline uint overlapping_lanes(global const float* p, const BvhBox* b) {
    return lane_bits(as_mask((load_lanes(0, p) <= (floatN)b->max_x) & (load_lanes(0, p + WIDTH) <= (floatN)b->max_y) &
                             (load_lanes(0, p + 2 * WIDTH) <= (floatN)b->max_z) & (load_lanes(0, p + 3 * WIDTH) >= (floatN)b->min_x) &
                             (load_lanes(0, p + 4 * WIDTH) >= (floatN)b->min_y) & (load_lanes(0, p + 5 * WIDTH) >= (floatN)b->min_z)));
}

// Boxes of a block that overlap *b, as bits.
inline uint overlapping(global const float* block, const BvhBox* b) {
    uint bits = 0;
    for (uint s = 0; s < STEPS; ++s) bits |= overlapping_lanes(block + s * LANES, b) << (s * LANES);
    return bits;
}

#if LANES > 1
// Boxes that overlap the box around the block in search, packed together: tested against the boxes of the block as
// whole vectors when there are enough, instead of a few of each block they come from.
#define MOST_CANDIDATES 256
#define CANDIDATES (MOST_CANDIDATES + LANES)  // a whole vector fits behind the last

// On cache lines, which vectors of them would cross else.
typedef struct {
    float columns[6 * CANDIDATES] __attribute__((aligned(64)));
    uint ids[CANDIDATES] __attribute__((aligned(64)));
    uint count;
    bool own;  // the first WIDTH are the block in search itself
} Candidates;

// Those of LANES boxes at `p` whose bits are set.
inline void add_candidates(Candidates* c, global const float* p, global const uint* ids, uint bits) {
    uint at = c->count;
#if COMPRESS
    for (uint d = 0; d < 6; ++d)
        store_floats(as_floatN(compress_lanes(as_uintN(load_lanes(0, p + d * WIDTH)), bits)), 0, c->columns + d * CANDIDATES + at);
    store_lanes(compress_lanes(load_lanes(0, ids), bits), 0, c->ids + at);
#else
    for (uint left = bits; left != 0; left &= left - 1, ++at) {
        uint l = lowest_bit(left);
        for (uint d = 0; d < 6; ++d) c->columns[d * CANDIDATES + at] = p[d * WIDTH + l];
        c->ids[at] = ids[l];
    }
#endif
    c->count += popcount(bits);
}

// Vectors of candidates that overlap a box of the block in search: bit l of `bits` is lane l.
typedef struct {
    uint bits[WIDTH * (CANDIDATES / LANES) + 1];
    uint row_and_vector[WIDTH * (CANDIDATES / LANES) + 1];  // row * 256 + vector
    uint count;
} Hits;

// Adds the vectors of candidates, `vectors` in all, that overlap box `row` of the block; those before candidate `from`
// do not count. Without branches on what is hit, which a CPU could not foresee.
inline void find_hits(const Candidates* c, const BvhBox* box, uint row, uint from, uint vectors, Hits* h) {
    const floatN min_x = box->min_x, min_y = box->min_y, min_z = box->min_z;
    const floatN max_x = box->max_x, max_y = box->max_y, max_z = box->max_z;
    uint v = from / LANES, wanted = ALL_LANES << (from - v * LANES), at = h->count;
    for (; v < vectors; ++v, wanted = ALL_LANES) {
        const float* p = c->columns + v * LANES;
        uint bits = lane_bits(as_mask((load_lanes(0, p) <= max_x) & (load_lanes(0, p + CANDIDATES) <= max_y) &
                                      (load_lanes(0, p + 2 * CANDIDATES) <= max_z) & (load_lanes(0, p + 3 * CANDIDATES) >= min_x) &
                                      (load_lanes(0, p + 4 * CANDIDATES) >= min_y) & (load_lanes(0, p + 5 * CANDIDATES) >= min_z)));
        bits &= wanted;
        h->bits[at] = bits;
        h->row_and_vector[at] = row << 8 | v;
        at += bits != 0 ? 1 : 0;
    }
    h->count = at;
}

// Pairs of the boxes of block q with the candidates; forgets those.
inline void test_candidates(global const float* tree, global const uint* order, uint q, const Range* range, Candidates* c,
                            PairSink* sink) {
    global const float* block = tree + q * (ulong)BLOCK;
    const uint vectors = (c->count + LANES - 1) / LANES;
    store_floats((floatN)(INFINITY), 0, c->columns + c->count);  // behind the last: no box
    Hits h;
    h.count = 0;
    for (uint l = 0; l < WIDTH; ++l) {
        BvhBox box = box_in(block, l);
        find_hits(c, &box, l, c->own ? l + 1 : 0, vectors, &h);  // of the block itself, those behind the box
    }
    for (uint i = 0; i < h.count; ++i) {
        uint v = h.row_and_vector[i] & 255, l = h.row_and_vector[i] >> 8;
        uint bits = h.bits[i];
        if (!range->all)
            bits &= lanes_in_range(range, load_lanes(v, c->columns + range->axis * CANDIDATES), block[range->axis * WIDTH + l]);
        sink_put_lanes(sink, c->ids + v * LANES, bits, order[q * WIDTH + l]);
    }
    sink->counts.tests += WIDTH * c->count;
    c->count = 0;
    c->own = false;
}

// Block j of the other tree against the box around block q.
inline void visit_block(global const float* tree, global const uint* order, uint q, global const float* other,
                        global const uint* other_order, uint j, const BvhBox* box, const Range* range, Candidates* c,
                        PairSink* sink) {
    if (c->count > MOST_CANDIDATES - WIDTH) test_candidates(tree, order, q, range, c, sink);
    for (uint s = 0; s < STEPS; ++s) {
        global const float* p = other + j * (ulong)BLOCK + s * LANES;
        uint bits = overlapping_lanes(p, box);
        if (bits != 0) add_candidates(c, p, other_order + j * WIDTH + s * LANES, bits);
    }
    sink->counts.tests += WIDTH;
}
#else
// Pairs of the boxes `rows` of block a of one tree with the boxes `columns` of block b of another. If they are `own`,
// one and the same block: of those behind the row only.
inline void test_rows(global const float* tree, global const uint* order, uint a, uint rows, global const float* other,
                      global const uint* other_order, uint b, uint columns, bool own, const Range* range, PairSink* sink) {
    global const float* block = tree + a * (ulong)BLOCK;
    sink->counts.tests += WIDTH * popcount(rows);
    for (uint s = 0; s < STEPS; ++s) {
        // Held here: what the sink writes could be anywhere, for all a compiler knows.
        global const float* p = other + b * (ulong)BLOCK + s * LANES;
        const floatN min_x = load_lanes(0, p), min_y = load_lanes(0, p + WIDTH), min_z = load_lanes(0, p + 2 * WIDTH);
        const floatN max_x = load_lanes(0, p + 3 * WIDTH), max_y = load_lanes(0, p + 4 * WIDTH), max_z = load_lanes(0, p + 5 * WIDTH);
        uint wanted = columns >> (s * LANES) & ALL_LANES;
        for (uint left = rows; left != 0; left &= left - 1) {
            uint l = lowest_bit(left);
            BvhBox box = box_in(block, l);
            uintN m = as_mask((min_x <= (floatN)box.max_x) & (min_y <= (floatN)box.max_y) & (min_z <= (floatN)box.max_z) &
                              (max_x >= (floatN)box.min_x) & (max_y >= (floatN)box.min_y) & (max_z >= (floatN)box.min_z));
            uint hits = lane_bits(m) & wanted;
            if (own) hits &= (0xfffffffeu << l) >> (s * LANES);
            if (!range->all)
                hits &= lanes_in_range(range, load_lanes(0, p + range->axis * WIDTH), block[range->axis * WIDTH + l]);
            if (hits != 0) sink_put_lanes(sink, other_order + b * WIDTH + s * LANES, hits, order[a * WIDTH + l]);
        }
    }
}

// Block q against block j of the other tree; `box` is around q.
inline void visit_block(global const float* tree, global const uint* order, uint q, global const float* other,
                        constant BvhLevels* other_levels, global const uint* other_order, uint j, const BvhBox* box, bool own,
                        const Range* range, PairSink* sink) {
    BvhBox other_box = box_in(other + (other_levels->first[1] + j / WIDTH) * (ulong)BLOCK, j % WIDTH);
    uint rows = overlapping(tree + q * (ulong)BLOCK, &other_box);
    uint columns = overlapping(other + j * (ulong)BLOCK, box);
    sink->counts.tests += 2 * WIDTH;
    if (popcount(rows) <= popcount(columns))
        test_rows(tree, order, q, rows, other, other_order, j, columns, own, range, sink);
    else
        test_rows(other, other_order, j, columns, tree, order, q, rows, own, range, sink);
}
#endif

#define WIDTH_BITS (WIDTH == 8 ? 3 : WIDTH == 16 ? 4 : 5)
#define ALL_BITS (WIDTH == 32 ? 0xffffffffu : (1u << (WIDTH & 31)) - 1)

// Nodes of block `block` of level `level` that overlap *box and hold blocks of level 0 in [from, last].
inline uint nodes_to_visit(global const float* tree, constant BvhLevels* levels, uint level, uint block, const BvhBox* box, uint from,
                           uint last, PairSink* sink) {
    uint shift = (level - 1) * WIDTH_BITS;
    uint low = from >> shift, high = last >> shift;  // nodes of this level
    uint bits = overlapping(tree + (levels->first[level] + block) * (ulong)BLOCK, box);
    sink->counts.tests += WIDTH;
    if (block == low / WIDTH) bits &= ALL_BITS << (low % WIDTH);
    if (block == high / WIDTH) bits &= ALL_BITS >> (WIDTH - 1 - high % WIDTH);
    return bits;
}

// Block q against the blocks [from, last] of level 0 of the other tree. If that is the `same`, from >= q.
inline void search(global const float* tree, constant BvhLevels* levels, global const uint* order, uint q,
                   global const float* other, constant BvhLevels* other_levels, global const uint* other_order, bool same,
                   uint from, uint last, uint axis, float low, float high, PairSink* sink) {
    BvhBox box = box_in(tree + (levels->first[1] + q / WIDTH) * (ulong)BLOCK, q % WIDTH);
    Range range;
    set_range(&range, axis, low, high, &box);
#if LANES > 1
    Candidates candidates;
    candidates.count = 0;
    candidates.own = same && from == q;
    if (candidates.own) {
        for (uint s = 0; s < STEPS; ++s)
            add_candidates(&candidates, tree + q * (ulong)BLOCK + s * LANES, order + q * WIDTH + s * LANES, ALL_LANES);
        ++from;
    }
#endif
    uint left[MOST_LEVELS];  // nodes still to visit
    uint level = other_levels->top, block = 0;
    left[level] = from <= last ? nodes_to_visit(other, other_levels, level, 0, &box, from, last, sink) : 0;
    for (;;) {
        uint nodes = left[level];
        if (nodes == 0) {
            if (level == other_levels->top) break;
            ++level;
            block /= WIDTH;
            continue;
        }
        left[level] = nodes & (nodes - 1);
        uint node = block * WIDTH + lowest_bit(nodes);
        if (level > 1) {
            block = node;
            --level;
            left[level] = nodes_to_visit(other, other_levels, level, block, &box, from, last, sink);
            continue;
        }
#if LANES > 1
        visit_block(tree, order, q, other, other_order, node, &box, &range, &candidates, sink);
#else
        visit_block(tree, order, q, other, other_levels, other_order, node, &box, same && node == q, &range, sink);
#endif
    }
#if LANES > 1
    test_candidates(tree, order, q, &range, &candidates, sink);
#endif
}

// One task: one block of the tree against the other tree, which may be the `same`; with WINDOW, against one window of
// the other's blocks: task = window * blocks + block.
kernel void bvh_search(global const float* restrict tree, constant BvhLevels* levels, global const uint* restrict order,
                       global const float* restrict other, constant BvhLevels* other_levels, global const uint* restrict other_order,
                       uint same, uint axis, float low, float high, SINK_PARAMS) {
    PairSink sink = sink_begin(SINK_ARGS);
    for (uint task = sink_task(&sink); task < sink.task_end; task = sink_task(&sink)) {
#if WINDOW
        uint window = task / levels->blocks, q = task - window * levels->blocks;
        uint from = window * WINDOW, last = min(other_levels->blocks, (window + 1) * WINDOW) - 1;
#else
        uint q = task, from = 0, last = other_levels->blocks - 1;
#endif
        if (same) from = max(from, q);
        if (from <= last) search(tree, levels, order, q, other, other_levels, other_order, same != 0, from, last, axis, low, high, &sink);
    }
    sink_end(&sink);
}
