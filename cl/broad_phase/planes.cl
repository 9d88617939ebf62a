// Boxes against planes (half-spaces), which have no box: one bit a (plane, box), 32 boxes a word.
//
//   planes_test  boxes (Aabb rows), n, planes (normal, offset; world space, float4) -> words
//                one work-item a word; word w of plane p is number p * words_per_plane + w
// Defines: none
#include "common/half_space.clh"

kernel void planes_test(global const float* restrict boxes, uint n, global const float4* restrict planes, uint plane_count,
                        uint words_per_plane, global uint* restrict words) {
    uint item = get_global_id(0);
    if (item >= plane_count * words_per_plane) return;
    uint p = item / words_per_plane;
    float4 plane = planes[p];
    uint first = (item - p * words_per_plane) * 32;
    uint end = min(n, first + 32);
    uint word = 0;
    for (uint i = first; i < end; ++i) {
        global const float* b = boxes + (ulong)i * 6;
        if (reaches_half_space(plane.x, plane.y, plane.z, plane.w, b[0], b[1], b[2], b[3], b[4], b[5])) word |= 1u << (i - first);
    }
    words[item] = word;
}
