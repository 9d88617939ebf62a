// Brute force [thesis 3.1.2, 4.2]: every box against every other, results as bits, one bit a pair,
// then count, scan, fill. Boxes come as columns (see columns.cl), `stride` floats each, padded with NaN
// to whole blocks of BLOCK columns.
//
// The triangle of pairs (row < column) is cut into square tiles of BLOCK x BLOCK. Tiles are numbered
// as pairs are, the diagonal included, and a work-group decodes its number with the thesis' formula (pair_index.clh).
// A work-item takes one row of the tile at a time and compares it with LANES columns a step, 32 steps a word:
//   word w of an entry (row, block), bit t   <->   column (w / LANES) * 32 * LANES + t * LANES + w % LANES
// so that bits are made without any shuffle between lanes. Only entries with a hit are stored; `counts` says
// which those are.
//
//   brute_tiles  columns -> bits (BLOCK / 32 words an entry), counts (hits an entry)
//                one work-group a slice of a tile, any size; entries of rows [row_first, row_end) only
//   brute_fill   bits, counts, offsets (their scan) -> pairs, rows and columns ascending
//                one work-item FILL_ENTRIES entries
// Defines: LANES; FILTERS (0): 1 applies group, mask and motion before a pair is counted
#include "common/lanes.clh"
#include "common/pair_index.clh"

#ifndef FILTERS
#define FILTERS 0
#endif
#define BLOCK 512
#define WORDS (BLOCK / 32)
#define FILL_ENTRIES 16
#define PASS (32 * LANES)  // columns that one word a lane covers

// Where a batch of rows stands: entry (row, block) is number (row - row_first) * width + block - block_first.
inline ulong entry_of(uint row, uint block, uint row_first, uint blocks) {
    uint block_first = row_first / BLOCK;
    return (ulong)(row - row_first) * (blocks - block_first) + (block - block_first);
}

// Column, within its block, of bit t of word w.
inline uint column_of(uint w, uint t) { return (w / LANES) * PASS + t * LANES + w % LANES; }

// Hits of the box `row` against PASS columns from `c` on: bit t of lane l is column t * LANES + l.
// Columns before step `t` are left out.
inline uintN test_row(global const float* columns, uint stride, uint row, uint c, uint t) {
    global const float* r = columns + row;
    const ulong s = stride;
    const floatN row_min_x = r[0], row_min_y = r[s], row_min_z = r[2 * s];
    const floatN row_max_x = r[3 * s], row_max_y = r[4 * s], row_max_z = r[5 * s];
    global const float* p = columns + c;
    uintN hits = 0;
    for (; t < 32; ++t) {
        uintN m = as_mask((load_lanes(t, p) <= row_max_x) & (load_lanes(t, p + s) <= row_max_y) &
                          (load_lanes(t, p + 2 * s) <= row_max_z) & (load_lanes(t, p + 3 * s) >= row_min_x) &
                          (load_lanes(t, p + 4 * s) >= row_min_y) & (load_lanes(t, p + 5 * s) >= row_min_z));
        hits |= m & (uintN)(1u << t);
    }
    return hits;
}

#if FILTERS
// Filters come as (group, mask, can move, unused) a body. Clears the bits of pairs that do not
// pass; adds up what was dropped: [0] by group and mask, [1] since neither can move.
inline uint filter_word(uint hits, uint row, uint block, uint w, global const uint4* filters, uint* dropped) {
    uint4 f = filters[row];
    uint kept = hits;
    for (uint left = hits; left != 0; left &= left - 1) {
        uint bit = left & (0u - left);
        uint4 g = filters[block * BLOCK + column_of(w, 31 - clz(bit))];
        bool allowed = (f.x & g.y) != 0 && (g.x & f.y) != 0;
        bool moves = (f.z | g.z) != 0;
        if (!allowed) dropped[0] += 1;
        if (allowed && !moves) dropped[1] += 1;
        if (!allowed || !moves) kept &= ~bit;
    }
    return kept;
}
#endif

// Tests one row against one block and stores the entry. Columns up to the row itself do not count.
inline void test_entry(global const float* columns, uint stride, uint row, uint block, ulong entry,
                       global uint* bits, global uint* counts
#if FILTERS
                       , global const uint4* filters, uint* dropped
#endif
) {
    uint count = 0;
    for (uint pass = 0; pass < BLOCK / PASS; ++pass) {
        uint c = block * BLOCK + pass * PASS;
        uintN hits = 0;
        uint steps_left_out = row < c ? 0 : min(32u, (row - c) / LANES);
        if (steps_left_out < 32) hits = test_row(columns, stride, row, c, steps_left_out);
        if (row >= c && steps_left_out < 32 && any_bit(hits) != 0) {
            // The step that holds the row itself: its lanes up to the row are no pairs.
            uint words[LANES];
            store_lanes(hits, 0, words);
            for (uint l = 0; l <= (row - c) % LANES; ++l) words[l] &= ~(1u << steps_left_out);
            hits = load_lanes(0, words);
        }
        if (any_bit(hits) != 0) {
#if FILTERS
            uint words[LANES];
            store_lanes(hits, 0, words);
            for (uint l = 0; l < LANES; ++l)
                if (words[l] != 0) words[l] = filter_word(words[l], row, block, pass * LANES + l, filters, dropped);
            hits = load_lanes(0, words);
#endif
            // The first hit of an entry clears the words of the passes before it.
            if (count == 0)
                for (uint w = 0; w < pass * LANES; ++w) bits[entry * WORDS + w] = 0;
            count += sum_lanes(popcount(hits));
        }
        if (count != 0) store_lanes(hits, pass, bits + entry * WORDS);
    }
    counts[entry] = count;
}

kernel void brute_tiles(global const float* restrict columns, uint stride, uint blocks, ulong first_tile, uint slices,
                        uint row_first, uint row_end, global uint* restrict bits, global uint* restrict counts
#if FILTERS
                        , global const uint4* restrict filters, volatile global uint* dropped_total, local uint* dropped_group
#endif
) {
    // Remainders by subtraction: oclgrind cannot follow what a compiler makes of / and % side by side.
    uint group_tile = (uint)get_group_id(0) / slices;
    uint slice = (uint)get_group_id(0) - group_tile * slices;
    ulong tile = first_tile + group_tile;
    uint row_block, block;
    decode_pair(tile, (ulong)blocks + 1, &row_block, &block);
    block -= 1;  // the diagonal is in: column 0 of the pairs of blocks + 1 things has no tile

    uint rows = BLOCK / slices;
    uint row = max(row_first, row_block * BLOCK + slice * rows);
    uint end = min(row_end, row_block * BLOCK + (slice + 1) * rows);
#if FILTERS
    uint dropped[2] = {0, 0};
#endif
    for (row += get_local_id(0); row < end; row += get_local_size(0)) {
        ulong entry = entry_of(row, block, row_first, blocks);
#if FILTERS
        test_entry(columns, stride, row, block, entry, bits, counts, filters, dropped);
#else
        test_entry(columns, stride, row, block, entry, bits, counts);
#endif
        // Blocks left of the diagonal belong to no tile; the scan reads their counts.
        if (row_block == block)
            for (uint left = row_first / BLOCK; left < block; ++left) counts[entry_of(row, left, row_first, blocks)] = 0;
    }
#if FILTERS
    if (get_local_id(0) < 2) dropped_group[get_local_id(0)] = 0;
    if (get_local_size(0) == 1) dropped_group[1] = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (dropped[0] != 0) atomic_add((volatile local uint*)dropped_group, dropped[0]);
    if (dropped[1] != 0) atomic_add((volatile local uint*)dropped_group + 1, dropped[1]);
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) == 0 && dropped_group[0] != 0) atomic_add(dropped_total, dropped_group[0]);
    if (get_local_id(0) == 0 && dropped_group[1] != 0) atomic_add(dropped_total + 1, dropped_group[1]);
#endif
}

// Writes the pairs of one entry from pairs[at] on.
inline void fill_entry(global const uint* words, uint row, uint first_column, ulong at, global uint* pairs) {
    for (uint pass = 0; pass < BLOCK / PASS; ++pass) {
        uint steps = any_bit(load_lanes(pass, words));
        for (; steps != 0; steps &= steps - 1) {
            uint t = 31 - clz(steps & (0u - steps));
            for (uint l = 0; l < LANES; ++l) {
                uint w = pass * LANES + l;
                if (((words[w] >> t) & 1) == 0) continue;
                pairs[2 * at] = row;
                pairs[2 * at + 1] = first_column + column_of(w, t);
                ++at;
            }
        }
    }
}

// Entries [entry_first, entry_end), FILL_ENTRIES a work-item since most are empty; the pairs of the first go to pairs[0].
kernel void brute_fill(global const uint* restrict bits, global const uint* restrict counts,
                       global const uint* restrict offsets, uint entry_first, uint entry_end, uint row_first, uint blocks,
                       global uint* restrict pairs) {
    uint block_first = row_first / BLOCK;
    uint width = blocks - block_first;
    uint entry = entry_first + get_global_id(0) * FILL_ENTRIES;
    for (uint last = min(entry_end, entry + FILL_ENTRIES); entry < last; ++entry) {
        if (counts[entry] == 0) continue;
        uint batch_row = entry / width;
        uint column = (block_first + (entry - batch_row * width)) * BLOCK;
        fill_entry(bits + (ulong)entry * WORDS, row_first + batch_row, column, offsets[entry] - offsets[entry_first], pairs);
    }
}
