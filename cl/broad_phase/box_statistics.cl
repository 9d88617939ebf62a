// How large boxes are and where: what algorithms choose cells, axes and layers by.
//
//   box_statistics  boxes (Aabb rows, from box `first` on), n, per_run, samples -> one record a run, of RECORD + 3 samples words:
//                   lowest and highest min corner (6 floats), then for each class of width (see width_class) a count and
//                   the largest width, then the min corners of `samples` boxes taken evenly from the run (NaN: no box)
// Boxes that are no boxes are left out. The width of a box is its longest side. One work-item a run, any
// work-group size. Defines: none
#include "common/box.clh"

#define CLASSES 512
#define RECORD (6 + 2 * CLASSES)

// Half octaves of float32: the exponent and the first bit behind it.
inline uint width_class(float width) { return as_uint(width) >> 22; }

kernel void box_statistics(global const float* restrict boxes, ulong first, uint n, uint per_run, uint runs, uint samples,
                           global float* restrict records) {
    uint run = get_global_id(0);
    if (run >= runs) return;
    uint count[CLASSES];
    float wide[CLASSES];
    for (uint c = 0; c < CLASSES; ++c) {
        count[c] = 0;
        wide[c] = 0.0f;
    }
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    uint begin = min((ulong)n, (ulong)run * per_run), end = min((ulong)n, (ulong)(run + 1) * per_run);
    for (uint i = begin; i < end; ++i) {
        global const float* box = boxes + (first + i) * 6;
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
    global float* record = records + (ulong)run * (RECORD + 3 * samples);
    for (uint d = 0; d < 3; ++d) {
        record[d] = low[d];
        record[3 + d] = high[d];
    }
    for (uint c = 0; c < CLASSES; ++c) {
        record[6 + c] = as_float(count[c]);
        record[6 + CLASSES + c] = wide[c];
    }
    for (uint k = 0; k < samples; ++k) {
        uint i = begin + (uint)((ulong)(end - begin) * k / samples);
        global const float* box = boxes + (first + (i < end ? i : 0)) * 6;
        bool valid = i < end && is_box(box);
        for (uint d = 0; d < 3; ++d) record[RECORD + 3 * k + d] = valid ? box[d] : NAN;
    }
}
