// Manifolds of contacts of two boxes, PAIR_LANES of them at once: see manifold_boxes.clh for the method.
//
//   find_box_manifolds   columns of contacts, bodies, shapes -> up to `wanted` points of each
// Any work-group size. Defines: LANES, REAL_BITS, PAIR_LANES, EXACT_FP32 (see real.clh).
#include "narrow_phase/body.clh"
#include "narrow_phase/manifold_boxes.clh"
#include "narrow_phase/manifold_columns.clh"

// Inputs of PAIR_LANES contacts, gathered: columns of it, in this order.
#define GATHERED_A 0           // turn 9, size 3
#define GATHERED_B 12          // the same
#define GATHERED_BETWEEN 24    // 3
#define GATHERED_NORMAL 27     // 3
#define GATHERED_POINT 30      // 3
#define GATHERED_DISTANCE 33
#define GATHERED_ERROR 34
#define GATHERED_LIMIT 35
#define GATHERED 36

inline void gather_body(REAL_SCALAR* g, global const BodyFrame* body, global const NarrowShape* shapes) {
    for (uint d = 0; d < 9; ++d) g[d * PAIR_LANES] = body->turn[d];
    for (uint d = 0; d < 3; ++d) g[(9 + d) * PAIR_LANES] = shapes[body->shape].size[d];
}

inline void gather_contact(REAL_SCALAR* g, const Columns* in, uint i, global const BodyFrame* bodies,
                           global const NarrowShape* shapes, global const float* margins, uint with_margins) {
    const uint row_a = in->words[IN_A * in->stride + i], row_b = in->words[IN_B * in->stride + i];
    global const BodyFrame *a = bodies + row_a, *b = bodies + row_b;
    gather_body(g + GATHERED_A * PAIR_LANES, a, shapes);
    gather_body(g + GATHERED_B * PAIR_LANES, b, shapes);
    for (uint d = 0; d < 3; ++d) {
        g[(GATHERED_BETWEEN + d) * PAIR_LANES] = coordinate_between(a, b, d);
        g[(GATHERED_NORMAL + d) * PAIR_LANES] = column_real(in, IN_NORMAL + d, 1 + d, i);
        g[(GATHERED_POINT + d) * PAIR_LANES] = column_real(in, IN_POINT + d, 4 + d, i);
    }
    g[GATHERED_DISTANCE * PAIR_LANES] = column_real(in, IN_DISTANCE, 0, i);
    g[GATHERED_ERROR * PAIR_LANES] = as_float(in->words[IN_ERROR * in->stride + i]);
    g[GATHERED_LIMIT * PAIR_LANES] = with_margins ? (REAL_SCALAR)margins[row_a] + (REAL_SCALAR)margins[row_b] : 0;
}

inline real gathered_at(const REAL_SCALAR* g, uint column) { return load_reals(g + column * PAIR_LANES); }
inline v3 gathered_vector(const REAL_SCALAR* g, uint column) {
    return v_of(gathered_at(g, column), gathered_at(g, column + 1), gathered_at(g, column + 2));
}
inline void gathered_side(const REAL_SCALAR* g, Side* side) {
    for (uint d = 0; d < 9; ++d) side->turn.m[d] = gathered_at(g, d);
    for (uint d = 0; d < 3; ++d) side->size[d] = gathered_at(g, 9 + d);
}

// What is found of PAIR_LANES contacts, a number each; rows of FOUND of them a point.
#define FOUND_KIND OUT_COLUMNS
#define FOUND_OF_A (OUT_COLUMNS + 1)
#define FOUND_OF_B (OUT_COLUMNS + 2)
#define FOUND_VALID (OUT_COLUMNS + 3)
#define FOUND_ROLE (OUT_COLUMNS + 4)
#define FOUND (OUT_COLUMNS + 5)

inline void store_point(const BoxManifold* m, uint k, REAL_SCALAR* to) {
    store_reals(m->on_a[k].x, to + OUT_POINT * PAIR_LANES);
    store_reals(m->on_a[k].y, to + (OUT_POINT + 1) * PAIR_LANES);
    store_reals(m->on_a[k].z, to + (OUT_POINT + 2) * PAIR_LANES);
    store_reals(m->along[k], to + OUT_DISTANCE * PAIR_LANES);
    store_reals(m->off[k], to + OUT_ERROR * PAIR_LANES);
    store_reals(m->kind[k], to + FOUND_KIND * PAIR_LANES);
    store_reals(m->of_a[k], to + FOUND_OF_A * PAIR_LANES);
    store_reals(m->of_b[k], to + FOUND_OF_B * PAIR_LANES);
    store_reals(m->role[k], to + FOUND_ROLE * PAIR_LANES);
    store_reals(choose(m->valid[k], number(1.0), number(0.0)), to + FOUND_VALID * PAIR_LANES);
}

// The name manifold.clh has for it.
inline uint feature_of(const REAL_SCALAR* found) {
    const uint kind = (uint)found[FOUND_KIND * PAIR_LANES], a = (uint)found[FOUND_OF_A * PAIR_LANES],
               b = (uint)found[FOUND_OF_B * PAIR_LANES];
    return kind == 0u ? 0u : kind << 30 | (kind == 1u ? a : kind == 2u ? b : a << 15 | b);
}

// Work-item i owns contacts [i per_item, (i + 1) per_item) of the `listed` ones, or of all; per_item is a multiple of PAIR_LANES.
kernel void find_box_manifolds(global const uint* restrict contacts, ulong stride, uint with_rests, global const uint* restrict list,
                               uint listed, uint count, uint per_item, global const BodyFrame* restrict bodies,
                               global const NarrowShape* restrict shapes, global const float* restrict margins, uint with_margins,
                               uint wanted, global REAL_SCALAR* restrict points, global uint* restrict features,
                               global uint* restrict counts, ulong out_stride) {
    Columns in = {contacts, stride, with_rests};
    for (uint i = get_global_id(0) * per_item, end = min(count, i + per_item); i < end; i += PAIR_LANES) {
        REAL_SCALAR g[GATHERED * PAIR_LANES], found[FOUND * PAIR_LANES * BOX_POINTS];
        uint at[PAIR_LANES];
        for (uint l = 0; l < PAIR_LANES; ++l) {
            const uint which = min(i + l, end - 1);
            at[l] = listed ? list[which] : which;
            gather_contact(g + l, &in, at[l], bodies, shapes, margins, with_margins);
        }
        Side a, b;
        gathered_side(g + GATHERED_A * PAIR_LANES, &a);
        gathered_side(g + GATHERED_B * PAIR_LANES, &b);
        BoxManifold m;
        m.normal = gathered_vector(g, GATHERED_NORMAL);
        m.point = gathered_vector(g, GATHERED_POINT);
        m.distance = gathered_at(g, GATHERED_DISTANCE);
        m.error = gathered_at(g, GATHERED_ERROR);
        m.limit = gathered_at(g, GATHERED_LIMIT);
        m.wanted = wanted;
        find_box_manifold(&a, &b, gathered_vector(g, GATHERED_BETWEEN), &m);
        for (uint k = 0; k < wanted; ++k) store_point(&m, k, found + k * FOUND * PAIR_LANES);
        for (uint l = 0; l < PAIR_LANES && i + l < end; ++l) {
            uint used = 0, deepest = 0, is_witness = 0;
            for (uint k = 0; k < wanted; ++k) {
                const REAL_SCALAR* from = found + k * FOUND * PAIR_LANES + l;
                if (from[FOUND_VALID * PAIR_LANES] == 0) continue;
                global REAL_SCALAR* out = points + used * OUT_COLUMNS * out_stride + at[l];
                for (uint c = 0; c < OUT_COLUMNS; ++c) out[c * out_stride] = from[c * PAIR_LANES];
                features[used * out_stride + at[l]] = feature_of(from);
                if (from[FOUND_ROLE * PAIR_LANES] != 0) {
                    deepest = used;
                    is_witness = from[FOUND_ROLE * PAIR_LANES] == 2;
                }
                ++used;
            }
            counts[at[l]] = COUNTED(used, deepest, is_witness);
        }
    }
}
