// The bounds stage: boxes of bodies from their poses and shapes, rounded outward.
// In: `count` body records, the shapes and vertices they name. Out: boxes[record.row] for each record; other
// boxes stay as they are. No defines; one work-item a record, any work-group size.
// The method and its proof are in common/bounds.clh.
#include "common/bounds.clh"

__kernel void compute_bounds(uint count, __global const BodyRecord* records, __global const ShapeRecord* shapes,
                             __global const float* vertices, __global BoxRecord* boxes) {
    const size_t i = get_global_id(0);
    if (i >= count) return;
    __global const BodyRecord* body = &records[i];
    clinch_bounds(body, shapes, vertices, &boxes[body->row]);
}
