// A sorted list of pairs that few pairs join and leave, brought up to date in place: by one pass over what moves.
//
// An edit adds a pair, or takes one that is there; edits ascend like the list. Pairs between one edit and the next all
// shift by the same number of places. The list is cut into blocks of `block` pairs, a work-item each. A shift is never
// larger than `halo`, so what other blocks write into a block lies in its first and last `halo` pairs; these are copied
// away first, and everything else is moved within memory: to the left from left to right, then to the right from right
// to left, so that nothing is written over before it was read. Needs no second list.
//
//   list_locate  pairs, edits -> at[e]: number of pairs before edit e's; for one that is taken, its place
//   list_save    pairs -> saved: the first and the last `halo` pairs of each block
//   list_edit    pairs, edits, at, saved -> pairs
// edits: (a, b, 1 adds or 0 takes, shift of the pairs before it). `shift_at_end` is that of the pairs after the last.
// Any work-group size. Defines: LANES
#include "common/lanes.clh"

kernel void list_locate(global const uint2* restrict pairs, uint count, global const uint4* restrict edits, uint edit_count,
                        global uint* restrict at) {
    uint e = get_global_id(0);
    if (e >= edit_count) return;
    uint4 edit = edits[e];
    uint low = 0, high = count;
    while (low < high) {
        uint middle = low + (high - low) / 2;
        uint2 p = pairs[middle];
        if (p.x < edit.x || (p.x == edit.x && p.y < edit.y))
            low = middle + 1;
        else
            high = middle;
    }
    at[e] = low;
}

// `words` uints, from the first on; `to` may overlap `from` if it lies before it.
inline void copy_up(global uint* to, global const uint* from, ulong words) {
    ulong i = 0;
#if LANES > 1
    for (; i + LANES <= words; i += LANES) store_lanes(load_lanes(0, from + i), 0, to + i);
#endif
    for (; i < words; ++i) to[i] = from[i];
}

// The same from the last on; `to` may overlap `from` if it lies behind it.
inline void copy_down(global uint* to, global const uint* from, ulong words) {
    ulong i = words;
#if LANES > 1
    for (; i >= LANES; i -= LANES) store_lanes(load_lanes(0, from + (i - LANES)), 0, to + (i - LANES));
#endif
    for (; i > 0; --i) to[i - 1] = from[i - 1];
}

// The three parts of a block: pairs [begin, middle) and [tail, end) are saved, those between stay.
typedef struct {
    uint begin, middle, tail, end;
} Block;

inline void block_at(uint number, uint block, uint halo, uint count, Block* b) {
    b->begin = number * block;
    b->end = count - b->begin < block ? count : b->begin + block;
    b->middle = b->begin + min(halo, b->end - b->begin);
    b->tail = b->end - min(halo, b->end - b->middle);
}

kernel void list_save(global const uint* restrict pairs, uint count, uint block, uint halo, uint blocks, global uint* restrict saved) {
    uint k = get_global_id(0);
    if (k >= blocks) return;
    Block b;
    block_at(k, block, halo, count, &b);
    global uint* to = saved + 4 * (ulong)k * halo;
    copy_up(to, pairs + 2 * (ulong)b.begin, 2 * (ulong)(b.middle - b.begin));
    copy_up(to + 2 * (ulong)halo, pairs + 2 * (ulong)b.tail, 2 * (ulong)(b.end - b.tail));
}

// What list_edit works on, and the edits of its block: [first, last).
typedef struct {
    global uint* pairs;
    global const uint4* edits;
    global const uint* at;
    uint edit_count, first, last;
    int shift_at_end;
} Edits;

inline uint first_edit(global const uint* at, uint count, uint place) {
    uint low = 0, high = count;
    while (low < high) {
        uint middle = low + (high - low) / 2;
        if (at[middle] < place)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

// Run number r of a block: the pairs that end at edit r, or at the end of the block.
inline uint run_begin(const Edits* e, uint r, const Block* b) {
    return r == e->first ? b->begin : e->at[r - 1] + (e->edits[r - 1].z == 0 ? 1 : 0);
}
inline uint run_end(const Edits* e, uint r, const Block* b) { return r == e->last ? b->end : e->at[r]; }
inline int run_shift(const Edits* e, uint r) { return r == e->edit_count ? e->shift_at_end : (int)e->edits[r].w; }

inline global uint* place(const Edits* e, uint pair, int shift) { return e->pairs + 2 * ((long)pair + shift); }

// Moves what a run has of [from, to), which is saved at `saved`.
inline void put_saved(const Edits* e, uint r, const Block* b, uint from, uint to, global const uint* saved) {
    uint begin = max(run_begin(e, r, b), from), end = min(run_end(e, r, b), to);
    if (begin < end) copy_up(place(e, begin, run_shift(e, r)), saved + 2 * (ulong)(begin - from), 2 * (ulong)(end - begin));
}

kernel void list_edit(global uint* pairs, uint count, uint block, uint halo, uint blocks, global const uint4* restrict edits,
                      global const uint* restrict at, uint edit_count, int shift_at_end, global const uint* restrict saved) {
    uint k = get_global_id(0);
    if (k >= blocks) return;
    Block b;
    block_at(k, block, halo, count, &b);
    Edits e;
    e.pairs = pairs;
    e.edits = edits;
    e.at = at;
    e.edit_count = edit_count;
    e.shift_at_end = shift_at_end;
    e.first = first_edit(at, edit_count, b.begin);
    e.last = k + 1 == blocks ? edit_count : first_edit(at, edit_count, b.end);
    for (uint r = e.first; r <= e.last; ++r) {
        uint begin = max(run_begin(&e, r, &b), b.middle), end = min(run_end(&e, r, &b), b.tail);
        int shift = run_shift(&e, r);
        if (begin < end && shift < 0) copy_up(place(&e, begin, shift), pairs + 2 * (ulong)begin, 2 * (ulong)(end - begin));
    }
    for (uint r = e.last + 1; r-- > e.first;) {
        uint begin = max(run_begin(&e, r, &b), b.middle), end = min(run_end(&e, r, &b), b.tail);
        int shift = run_shift(&e, r);
        if (begin < end && shift > 0) copy_down(place(&e, begin, shift), pairs + 2 * (ulong)begin, 2 * (ulong)(end - begin));
    }
    global const uint* head = saved + 4 * (ulong)k * halo;
    for (uint r = e.first; r <= e.last; ++r) {
        if (run_shift(&e, r) != 0) {
            put_saved(&e, r, &b, b.begin, b.middle, head);
            put_saved(&e, r, &b, b.tail, b.end, head + 2 * (ulong)halo);
        }
        if (r == e.last || edits[r].z == 0) continue;
        global uint* added = place(&e, at[r], run_shift(&e, r));
        added[0] = edits[r].x;
        added[1] = edits[r].y;
    }
}
