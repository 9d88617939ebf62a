// Pairs grouped by the classes of their two shapes, and the answers put back into the order of the pairs. The thesis
// sorts pairs by the algorithm of its matrix that they need [3.2.1]; here one pass of a stable radix sort does it.
//
//   place_records  records of changed rows -> their places
//   bucket_keys    pairs, class of each body -> key (number of the bucket) of each pair; pairs a bucket, a work-item
//   bucket_slots   numbers of pairs by bucket -> the slot where each pair's answer lies
//   open_count, open_fill   slots that float32 could not decide -> their list, and that of their pairs
//   open_slots     pairs done again -> the slots of their new answers
//   contact_count, contact_gather   answers in slots -> columns of contacts in the order of the pairs
// A slot is a place in the columns that cl/narrow_phase/driver.clh writes.
// Any work-group size. Defines: none; LANES is not used.
#define MOST_BUCKETS 32
#define HIT 1u
#define UNDECIDED 2u
#define FLOAT64 4u
#define COLUMNS 8   // of floats an answer has
#define RESTS 7     // more of them, of what the floats leave over of a float64 answer

kernel void place_records(global const uint* restrict records, global const uint* restrict rows, uint count, uint words,
                          global uint* restrict out) {
    uint i = get_global_id(0);
    if (i >= count) return;
    for (uint w = 0; w < words; ++w) out[rows[i] * (ulong)words + w] = records[i * (ulong)words + w];
}

// `table` has 64 entries: number of the bucket of classes a and b at 8 a + b. Pairs that no bucket takes, bodies that are not
// there among them, get the last one, MOST_BUCKETS - 1.
kernel void bucket_keys(global const uint2* restrict pairs, uint n, global const uchar* restrict classes, uint bodies,
                        constant uchar* table, uint per_item, uint items, global uint* restrict keys,
                        global uint* restrict counts) {
    uint item = get_global_id(0);
    if (item >= items) return;
    uint mine[MOST_BUCKETS];
    for (uint k = 0; k < MOST_BUCKETS; ++k) mine[k] = 0;
    for (uint i = item * per_item, end = min(n, i + per_item); i < end; ++i) {
        uint2 pair = pairs[i];
        uint a = pair.x < bodies ? classes[pair.x] : 255u, b = pair.y < bodies ? classes[pair.y] : 255u;
        uint key = a < 8 && b < 8 && pair.x < pair.y ? table[8 * a + b] : MOST_BUCKETS - 1;
        keys[i] = key;
        mine[key] += 1;
    }
    for (uint k = 0; k < MOST_BUCKETS; ++k) counts[item * MOST_BUCKETS + k] = mine[k];
}

// first_pair[k]: place of bucket k's first pair among the numbers; first_slot[k]: its slot. Not `listed`: there is one bucket.
kernel void bucket_slots(global const uint* restrict numbers, uint listed, uint n, constant uint* first_pair, constant uint* first_slot,
                         uint buckets, global uint* restrict slot_of) {
    uint i = get_global_id(0);
    if (i >= n) return;
    uint k = 0;
    while (k + 1 < buckets && first_pair[k + 1] <= i) ++k;
    slot_of[listed ? numbers[i] : i] = first_slot[k] + (i - first_pair[k]);
}

kernel void open_count(global const uint* restrict hits, uint first, uint count, uint per_run, uint runs,
                       global uint* restrict counts) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint open = 0;
    for (uint i = run * per_run, end = min(count, i + per_run); i < end; ++i) open += hits[first + i] & UNDECIDED ? 1 : 0;
    counts[run] = open;
}

// Of a bucket: numbers of its pairs in `numbers` from first_pair on (not `listed`: they are their own), slots from first_slot on.
kernel void open_fill(global const uint* restrict hits, uint first_slot, uint count, uint per_run, uint runs,
                      global const uint* restrict offsets, global const uint* restrict numbers, uint listed, uint first_pair,
                      global uint* restrict open) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint to = offsets[run];
    for (uint i = run * per_run, end = min(count, i + per_run); i < end; ++i)
        if (hits[first_slot + i] & UNDECIDED) open[to++] = listed ? numbers[first_pair + i] : first_pair + i;
}

kernel void open_slots(global const uint* restrict open, uint count, uint first_slot, global uint* restrict slot_of) {
    uint i = get_global_id(0);
    if (i < count) slot_of[open[i]] = first_slot + i;
}

kernel void contact_count(global const uint* restrict hits, global const uint* restrict slot_of, uint n, uint per_run,
                          uint runs, global uint* restrict counts) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint found = 0;
    for (uint i = run * per_run, end = min(n, i + per_run); i < end; ++i) found += hits[slot_of[i]] & HIT;
    counts[run] = found;
}

// Columns of contacts, each out_stride long: a, b, then, `with_answers`, the COLUMNS of answers, then, `with_rests`, the RESTS;
// those of float32 answers are 0.
kernel void contact_gather(global const uint2* restrict pairs, global const uint* restrict hits,
                           global const uint* restrict slot_of, uint n, uint per_run, uint runs,
                           global const uint* restrict offsets, global const uint* restrict slots, ulong stride, uint with_answers,
                           uint with_rests, global uint* restrict out, ulong out_stride) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint to = offsets[run];
    for (uint i = run * per_run, end = min(n, i + per_run); i < end; ++i) {
        uint slot = slot_of[i];
        if ((hits[slot] & HIT) == 0) continue;
        out[to] = pairs[i].x;
        out[out_stride + to] = pairs[i].y;
        for (uint c = 0; with_answers && c < COLUMNS; ++c) out[(2 + c) * out_stride + to] = slots[c * stride + slot];
        if (with_answers && with_rests)
            for (uint c = COLUMNS; c < COLUMNS + RESTS; ++c)
                out[(2 + c) * out_stride + to] = hits[slot] & FLOAT64 ? slots[c * stride + slot] : 0;
        ++to;
    }
}
