// Manifolds of contacts that are found already: see manifold.clh for the method.
//
//   find_manifolds   columns of contacts, bodies, shapes -> up to `wanted` points of each
// Each contact is a loop's round of its own and looks at the classes of its two bodies itself: one kernel for all of them,
// but two boxes, which manifold_boxes.cl does many times faster.
// Any work-group size. Defines: LANES; REAL_BITS: 32 or 64; PAIR_LANES=1; EXACT_FP32 (see real.clh).
#include "narrow_phase/body.clh"
#include "narrow_phase/manifold.clh"
#include "narrow_phase/manifold_columns.clh"

inline v3 column_vector(const Columns* c, uint column, uint rest, uint i) {
    return v_of(column_real(c, column, rest, i), column_real(c, column + 1, rest + 1, i), column_real(c, column + 2, rest + 2, i));
}

inline void patch_body(global const BodyFrame* frame, global const NarrowShape* shapes, global const REAL_SCALAR* vertices,
                       global const NarrowFace* faces, global const uint* corners, PatchBody* body) {
    global const NarrowShape* shape = shapes + frame->shape;
    for (uint d = 0; d < 3; ++d) body->side.size[d] = shape->size[d];
    for (uint d = 0; d < 9; ++d) body->side.turn.m[d] = frame->turn[d];
    body->side.vertices = vertices + shape->first_vertex;
    body->side.vertex_count = shape->vertex_count;
    body->side.stride = shape->stride;
    body->kind = shape->kind;
    body->faces = faces + shape->first_face;
    body->face_count = shape->face_count;
    body->corners = corners;
}

// Work-item i owns contacts [i per_item, (i + 1) per_item) of the `listed` ones, or of all.
kernel void find_manifolds(global const uint* restrict contacts, ulong stride, uint with_rests, global const uint* restrict list,
                           uint listed, uint count, uint per_item,
                           global const BodyFrame* restrict bodies, global const NarrowShape* restrict shapes,
                           global const REAL_SCALAR* restrict vertices, global const NarrowFace* restrict faces,
                           global const uint* restrict corners, global const float* restrict margins, uint with_margins,
                           uint wanted, global REAL_SCALAR* restrict points, global uint* restrict features,
                           global uint* restrict counts, ulong out_stride) {
    Columns in = {contacts, stride, with_rests};
    for (uint at = get_global_id(0) * per_item, end = min(count, at + per_item); at < end; ++at) {
        const uint i = listed ? list[at] : at;
        const uint row_a = contacts[IN_A * stride + i], row_b = contacts[IN_B * stride + i];
        PatchBody a, b;
        patch_body(bodies + row_a, shapes, vertices, faces, corners, &a);
        patch_body(bodies + row_b, shapes, vertices, faces, corners, &b);
        v3 between = v_of(coordinate_between(bodies + row_a, bodies + row_b, 0), coordinate_between(bodies + row_a, bodies + row_b, 1),
                          coordinate_between(bodies + row_a, bodies + row_b, 2));
        Manifold m;
        m.distance = column_real(&in, IN_DISTANCE, 0, i);
        m.error = as_float(contacts[IN_ERROR * stride + i]);
        m.normal = column_vector(&in, IN_NORMAL, 1, i);
        m.point = column_vector(&in, IN_POINT, 4, i);
        m.limit = with_margins ? (real)margins[row_a] + (real)margins[row_b] : number(0.0);
        m.wanted = wanted;
        find_manifold(&a, &b, between, &m);
        counts[i] = COUNTED(m.count, m.deepest, m.is_witness);
        for (uint k = 0; k < m.count; ++k) {
            global REAL_SCALAR* out = points + k * OUT_COLUMNS * out_stride + i;
            out[OUT_POINT * out_stride] = m.on_a[k].x;
            out[(OUT_POINT + 1) * out_stride] = m.on_a[k].y;
            out[(OUT_POINT + 2) * out_stride] = m.on_a[k].z;
            out[OUT_DISTANCE * out_stride] = m.points[k].distance;
            out[OUT_ERROR * out_stride] = m.points[k].error;
            features[k * out_stride + i] = m.points[k].feature;
        }
    }
}
