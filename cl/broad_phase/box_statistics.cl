// How large boxes are and where: what algorithms choose cells, axes and layers by.
//
//   box_statistics  boxes (Aabb rows, from box `first` on), n, per_run -> one record a run: corner[6] (lowest and
//                   highest min corner), then for each class of width (see width_class) a count and the largest width
// Boxes that are no boxes are left out. The width of a box is its longest side. One work-item a run, any
// work-group size. Defines: none
#include "common/box.clh"

#define CLASSES 512

// Half octaves of float32: the exponent and the first bit behind it.
inline uint width_class(float width) { return as_uint(width) >> 22; }

kernel void box_statistics(global const float* restrict boxes, ulong first, uint n, uint per_run, uint runs,
                           global float* restrict corners, global uint* restrict counts, global float* restrict widest) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint count[CLASSES];
    float wide[CLASSES];
    for (uint c = 0; c < CLASSES; ++c) {
        count[c] = 0;
        wide[c] = 0.0f;
    }
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    ulong begin = first + (ulong)run * per_run, end = first + min((ulong)n, (ulong)(run + 1) * per_run);
    for (ulong i = begin; i < end; ++i) {
        global const float* box = boxes + i * 6;
        if (!is_box(box)) continue;
        float width = 0.0f;
        for (uint d = 0; d < 3; ++d) {
            low[d] = fmin(low[d], box[d]);
            high[d] = fmax(high[d], box[d]);
            width = fmax(width, box[d + 3] - box[d]);
        }
        uint c = min(width_class(width), (uint)(CLASSES - 1));
        count[c] += 1;
        wide[c] = fmax(wide[c], width);
    }
    for (uint d = 0; d < 3; ++d) {
        corners[run * 6 + d] = low[d];
        corners[run * 6 + 3 + d] = high[d];
    }
    for (uint c = 0; c < CLASSES; ++c) {
        counts[run * CLASSES + c] = count[c];
        widest[run * CLASSES + c] = wide[c];
    }
}
