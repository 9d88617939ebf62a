// Closing the gaps that the last chunk of each work-item leaves (see pair_sink.clh).
//
//   sink_move  moves (from, to, count: runs of pairs that do not overlap) -> pairs; one work-item a move
// Defines: none

kernel void sink_move(global uint2* pairs, global const ulong* restrict moves, uint count) {
    uint i = get_global_id(0);
    if (i >= count) return;
    ulong from = moves[3 * (ulong)i], to = moves[3 * (ulong)i + 1], length = moves[3 * (ulong)i + 2];
    for (ulong k = 0; k < length; ++k) pairs[to + k] = pairs[from + k];
}
