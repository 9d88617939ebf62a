// Bounding volume hierarchy: boxes in Morton order [Lauterbach 2009], and above them a tree without pointers.
//
// The tree is implicit and complete: the boxes in Morton order are cut into blocks of WIDTH; node c of level 1 is the
// box around block c, the nodes of level 1 are cut into blocks again, and so on up to one block. A block is stored as
// columns (WIDTH min x, WIDTH min y, ... WIDTH max z), so that one box is tested against a whole block by vectors. That
// stands in for the binary radix tree of Karras 2012 and Apetrei 2014: a level needs only the level below it (no
// fence across work-groups), nothing is fewer or more than n tells (no pointer, no stack that could overflow), and a
// tree whose boxes moved a little is refitted by the passes that built it. Codes are cut off where finer ones
// would not change the blocks much, and boxes far larger than most come behind all others (the size in the code:
// Vinkler 2017), so that they do not widen the nodes of small ones; order is a matter of speed alone.
//
// Queries are blocks, not boxes: block q looks for blocks j >= q that its own box overlaps (half traversal, as in ArborX),
// so each pair is found once. Two blocks are compared box by box from the side where fewer boxes reach the
// other block's box: one planet among debris costs one vector test.
// The state of a traversal is one word of bits a level: the nodes of the current blocks still to visit.
//
//   bvh_keys    boxes (rows) -> key: class of size, then Morton code of the centre
//   bvh_leaves  boxes, order (payload of the sorted keys) -> blocks of boxes, and level 1
//   bvh_level   one level from the one below
//               both: -> measures (one a work-item): the size of nodes, and whether there is a box that is no box
//   bvh_search  tree, order -> pairs
// What is no box has its corners exchanged, at infinity: it overlaps nothing and adds nothing to a node.
// Defines: LANES, FILTERS; WIDTH (LANES, at least 8): boxes a block; KEY (uint): type of a key, uint or ulong;
// WINDOW (0): blocks that a task may look at where loops end early (see most_loop_iterations), 0: all
#include "common/lanes.clh"
#include "common/box.clh"
#include "broad_phase/pair_sink.clh"

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
    uint class_shift;     // bits of the Morton code
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

// Every third bit from a number of 21 bits.
inline ulong spread(uint v) {
    ulong x = v;
    x = (x | x << 32) & 0x001f00000000ffffUL;
    x = (x | x << 16) & 0x001f0000ff0000ffUL;
    x = (x | x << 8) & 0x100f00f00f00f00fUL;
    x = (x | x << 4) & 0x10c30c30c30c30c3UL;
    return (x | x << 2) & 0x1249249249249249UL;
}

inline ulong cell_of(float low, float high, uint d, constant BvhFrame* f) {
    float centre = 0.5f * low + 0.5f * high;
    return spread((uint)fmin(fmax((centre - f->origin[d]) * f->scale, 0.0f), f->most_cells));
}

kernel void bvh_keys(global const float* restrict boxes, ulong first, uint n, constant BvhFrame* f, global KEY* restrict keys) {
    uint i = get_global_id(0);
    if (i >= n) return;
    global const float* b = boxes + (first + i) * 6;
    float width = fmax(fmax(b[3] - b[0], b[4] - b[1]), b[5] - b[2]);
    ulong large = width <= f->size_limit[0] ? 0 : width <= f->size_limit[1] ? 1 : width <= f->size_limit[2] ? 2 : 3;
    ulong code = cell_of(b[0], b[3], 0, f) | cell_of(b[1], b[4], 1, f) << 1 | cell_of(b[2], b[5], 2, f) << 2;
    keys[i] = (KEY)(min(large, (ulong)f->most_class) << f->class_shift | code);
}

inline void write_node(global float* tree, uint first_block, uint node, const float* low, const float* high) {
    global float* at = tree + (first_block + node / WIDTH) * (ulong)BLOCK + node % WIDTH;
    for (uint d = 0; d < 3; ++d) {
        at[d * WIDTH] = low[d];
        at[(d + 3) * WIDTH] = high[d];
    }
}

// What a node adds to the measure. An empty one adds nothing.
inline float size_of(const float* low, const float* high, float scale) {
    float w = ((high[0] - low[0]) + (high[1] - low[1]) + (high[2] - low[2])) * scale;
    return w > 0.0f ? w * w * w : 0.0f;
}

// Work-item i owns nodes [i per_item, (i + 1) per_item) of level 1, `nodes` in all, padding included.
kernel void bvh_leaves(global const float* restrict boxes, ulong first, global const uint* restrict order, uint n,
                       constant BvhFrame* f, uint blocks, uint level_first, uint nodes, uint per_item, uint items,
                       global float* restrict tree, uint first_measure, global BvhMeasure* restrict measures) {
    uint item = get_global_id(0);
    if (item >= items) return;
    BvhMeasure m = {0.0f, 0};
    for (uint c = item * per_item, end = min(nodes, c + per_item); c < end; ++c) {
        float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
        for (uint l = 0; l < WIDTH && c < blocks; ++l) {
            uint i = c * WIDTH + l;
            global const float* box = boxes + (first + (i < n ? order[i] : 0)) * 6;
            bool valid = i < n && is_box(box);
            if (i < n && !valid) m.invalid = 1;
            for (uint d = 0; d < 3; ++d) {
                float a = valid ? box[d] : INFINITY, b = valid ? box[d + 3] : -INFINITY;
                tree[c * (ulong)BLOCK + d * WIDTH + l] = a;
                tree[c * (ulong)BLOCK + (d + 3) * WIDTH + l] = b;
                low[d] = fmin(low[d], a);
                high[d] = fmax(high[d], b);
            }
        }
        write_node(tree, level_first, c, low, high);
        m.size += size_of(low, high, f->measure);
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
        float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
        global const float* block = tree + (below_first + c) * (ulong)BLOCK;
        for (uint l = 0; l < WIDTH && c < below_blocks; ++l)
            for (uint d = 0; d < 3; ++d) {
                low[d] = fmin(low[d], block[d * WIDTH + l]);
                high[d] = fmax(high[d], block[(d + 3) * WIDTH + l]);
            }
        write_node(tree, level_first, c, low, high);
        m.size += size_of(low, high, f->measure);
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

// Boxes of a block that overlap *b, as bits.
inline uint overlapping(global const float* block, const BvhBox* b) {
    uint bits = 0;
    for (uint s = 0; s < STEPS; ++s) {
        global const float* p = block + s * LANES;
        uintN m = as_mask((load_lanes(0, p) <= (floatN)b->max_x) & (load_lanes(0, p + WIDTH) <= (floatN)b->max_y) &
                          (load_lanes(0, p + 2 * WIDTH) <= (floatN)b->max_z) & (load_lanes(0, p + 3 * WIDTH) >= (floatN)b->min_x) &
                          (load_lanes(0, p + 4 * WIDTH) >= (floatN)b->min_y) & (load_lanes(0, p + 5 * WIDTH) >= (floatN)b->min_z));
        bits |= lane_bits(m) << (s * LANES);
    }
    return bits;
}

// Pairs of the boxes `rows` of block a with the boxes `columns` of block b. In one and the same block: of those
// behind the row only.
inline void test_rows(global const float* tree, global const uint* order, uint a, uint b, uint rows, uint columns,
                      PairSink* sink) {
    global const float* block_a = tree + a * (ulong)BLOCK;
    global const float* block_b = tree + b * (ulong)BLOCK;
    for (; rows != 0; rows &= rows - 1) {
        uint l = lowest_bit(rows);
        BvhBox box = box_in(block_a, l);
        uint hits = overlapping(block_b, &box) & columns;
        if (a == b) hits &= 0xfffffffeu << l;
        sink->counts.tests += WIDTH;
        if (hits == 0) continue;
        uint id = order[a * WIDTH + l];
        for (; hits != 0; hits &= hits - 1) sink_put(sink, id, order[b * WIDTH + lowest_bit(hits)]);
    }
}

// Block q against block j; `box` is around q.
inline void test_blocks(global const float* tree, constant BvhLevels* levels, global const uint* order, uint q, uint j,
                        const BvhBox* box, PairSink* sink) {
    BvhBox other = box_in(tree + (levels->first[1] + j / WIDTH) * (ulong)BLOCK, j % WIDTH);
    uint rows = overlapping(tree + q * (ulong)BLOCK, &other);
    uint columns = overlapping(tree + j * (ulong)BLOCK, box);
    sink->counts.tests += 2 * WIDTH;
    if (popcount(rows) <= popcount(columns))
        test_rows(tree, order, q, j, rows, columns, sink);
    else
        test_rows(tree, order, j, q, columns, rows, sink);
}

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

// Block q against the blocks [from, last] of level 0; from >= q.
inline void search(global const float* tree, constant BvhLevels* levels, global const uint* order, uint q, uint from, uint last,
                   PairSink* sink) {
    BvhBox box = box_in(tree + (levels->first[1] + q / WIDTH) * (ulong)BLOCK, q % WIDTH);
    uint left[MOST_LEVELS];  // nodes still to visit
    uint level = levels->top, block = 0;
    left[level] = nodes_to_visit(tree, levels, level, 0, &box, from, last, sink);
    for (;;) {
        uint nodes = left[level];
        if (nodes == 0) {
            if (level == levels->top) break;
            ++level;
            block /= WIDTH;
            continue;
        }
        left[level] = nodes & (nodes - 1);
        uint node = block * WIDTH + lowest_bit(nodes);
        if (level == 1) {
            test_blocks(tree, levels, order, q, node, &box, sink);
        } else {
            block = node;
            --level;
            left[level] = nodes_to_visit(tree, levels, level, block, &box, from, last, sink);
        }
    }
}

// One task: one block; with WINDOW, one block against one window of blocks: task = window * blocks + block.
kernel void bvh_search(global const float* restrict tree, constant BvhLevels* levels, global const uint* restrict order, SINK_PARAMS) {
    PairSink sink = sink_begin(SINK_ARGS);
    for (uint task = sink_task(&sink); task < sink.task_end; task = sink_task(&sink)) {
#if WINDOW
        uint window = task / levels->blocks, q = task - window * levels->blocks;
        uint from = max(q, window * WINDOW), last = min(levels->blocks, (window + 1) * WINDOW) - 1;
        if (from <= last) search(tree, levels, order, q, from, last, &sink);
#else
        search(tree, levels, order, task, task, levels->blocks - 1, &sink);
#endif
    }
    sink_end(&sink);
}
