// Boxes from rows (Aabb, six floats each) to columns: min x of all, min y of all, ... max z of all.
// Boxes that are no boxes (NaN, infinite, min > max) and the padding behind the last become NaN, so
// that no comparison with them holds and no later kernel has to ask.
//
//   columns  boxes (from box `first` on), n, stride (length of a column, n rounded up)
//            -> out (6 columns), any_invalid (set to 1 if a box of the n is no box; the caller clears it)
// One atomic a work-group at most. Defines: none

#include "common/box.clh"

kernel void columns(global const float* restrict boxes, ulong first, uint n, uint stride, global float* restrict out,
                    volatile global uint* any_invalid, local uint* group_invalid) {
    uint i = get_global_id(0);
    if (get_local_id(0) == 0) *group_invalid = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (i < stride) {
        global const float* box = boxes + (first + i) * 6;
        bool valid = i < n && is_box(box);
        for (uint d = 0; d < 6; ++d) out[d * (ulong)stride + i] = valid ? box[d] : NAN;
        if (!valid && i < n) atomic_or((volatile local uint*)group_invalid, 1u);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_local_id(0) == 0 && *group_invalid != 0) atomic_or(any_invalid, 1u);
}
