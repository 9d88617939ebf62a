// Exclusive scan of uints: out[i] = in[0] + ... + in[i - 1], in three launches.
// Every work-item of the first and last kernel owns one run of `per_run` values; any work-group size
// fits. The sum of all values must be below 2^32.
// Source: count, scan, fill [Blelloch 1990]; reduce-then-scan order.
//
//   scan_runs     in, n, per_run -> run_sums (one a run)
//   scan_sums     run_sums, in place -> exclusive scan of them, total. One work-group.
//   scan_offsets  in, n, per_run, run_sums -> out
// Defines: none

kernel void scan_runs(global const uint* restrict in, uint n, uint per_run, uint runs, global uint* restrict run_sums) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint first = run * per_run;
    uint end = min(n, first + per_run);
    uint sum = 0;
    for (uint i = first; i < end; ++i) sum += in[i];
    run_sums[run] = sum;
}

kernel void scan_sums(global uint* restrict run_sums, uint runs, global uint* restrict total, local uint* part_sums) {
    uint item = get_local_id(0), items = get_local_size(0);
    uint per_item = (runs + items - 1) / items;
    uint first = min(runs, item * per_item), end = min(runs, first + per_item);
    uint sum = 0;
    for (uint i = first; i < end; ++i) sum += run_sums[i];
    part_sums[item] = sum;
    barrier(CLK_LOCAL_MEM_FENCE);
    uint before = 0;
    for (uint i = 0; i < item; ++i) before += part_sums[i];
    for (uint i = first; i < end; ++i) {
        uint value = run_sums[i];
        run_sums[i] = before;
        before += value;
    }
    if (item == items - 1) *total = before;
}

kernel void scan_offsets(global const uint* restrict in, uint n, uint per_run, uint runs,
                         global const uint* restrict run_sums, global uint* restrict out) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint first = run * per_run;
    uint end = min(n, first + per_run);
    uint sum = run_sums[run];
    for (uint i = first; i < end; ++i) {
        out[i] = sum;
        sum += in[i];
    }
}
