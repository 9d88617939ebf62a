#include "src/narrow_phase/host_narrow.hpp"

#include "src/primitives/host_parallel.hpp"
#include "src/scene/scene_impl.hpp"

namespace clinch::detail {
namespace {

constexpr std::size_t pairs_worth_threads = 256;

bool usable(const Scene::Impl& s, std::uint32_t row) {
    return row < s.row_count() && s.alive[row] != 0 && s.faults[row] == 0;
}

HostAnswer touch_pair(const Scene& scene, const NarrowShapes& shapes, const Pair& pair,
                      const RowTolerances& tolerances) {
    const Scene::Impl& s = scene.impl();
    const MatrixRow& row = *row_of(scene, shapes, pair);
    const bool swapped = shapes.records()[s.shape[pair.a]].kind != row.a;
    const std::uint32_t first = swapped ? pair.b : pair.a, second = swapped ? pair.a : pair.b;
    const host::Side a = host_side(scene, shapes, first), b = host_side(scene, shapes, second);
    const Vec3 &p = s.position[first], &q = s.position[second];
    const host::v3 between{q.x - p.x, q.y - p.y, q.z - p.z};
    const double limit = s.margin[pair.a] + s.margin[pair.b];
    host::Touch touch{};
    touch.limit = limit;
    touch.tolerance = tolerances[static_cast<std::size_t>(&row - matrix().data())];
    row.host(&a, &b, between, &touch);
    if (swapped) {
        touch.point = host::v_sub(host::v_along(touch.point, touch.distance, touch.normal), between);
        touch.normal = host::v_negative(touch.normal);
    }
    HostAnswer answer{pair.a,
                      pair.b,
                      touch.distance,
                      touch.error,
                      {touch.normal.x, touch.normal.y, touch.normal.z},
                      {touch.point.x, touch.point.y, touch.point.z},
                      false};
    // Turned round, so that what is not a number is kept.
    answer.hit = !(touch.distance - limit > touch.error);
    return answer;
}

}  // namespace

host::Side host_side(const Scene& scene, const NarrowShapes& shapes, std::uint32_t row) {
    const BodyFrame64 frame = frame_of(scene, row);
    const NarrowShape64& shape = shapes.records()[frame.shape];
    host::Side side{};
    for (std::size_t d = 0; d < 3; ++d) side.size[d] = shape.size[d];
    for (std::size_t i = 0; i < 9; ++i) side.turn.m[i] = frame.turn[i];
    side.normal = {shape.normal[0], shape.normal[1], shape.normal[2]};
    side.vertices = shapes.vertices().data() + shape.first_vertex;
    side.vertex_count = shape.vertex_count;
    side.stride = shape.stride;
    return side;
}

const MatrixRow* row_of(const Scene& scene, const NarrowShapes& shapes, const Pair& pair) {
    const Scene::Impl& s = scene.impl();
    if (pair.a >= pair.b || !usable(s, pair.a) || !usable(s, pair.b)) return nullptr;
    const std::size_t a = shapes.records()[s.shape[pair.a]].kind, b = shapes.records()[s.shape[pair.b]].kind;
    const std::uint8_t bucket = bucket_table()[8 * a + b];
    return bucket == no_bucket ? nullptr : &matrix()[bucket];
}

std::vector<HostAnswer> touch_on_host(const Scene& scene, const NarrowShapes& shapes, View<const Pair> pairs,
                                      const RowTolerances& tolerances) {
    std::vector<HostAnswer> answers(pairs.size());
    parallel_blocks(pairs.size(), pairs_worth_threads,
                    [&](std::size_t i) { answers[i] = touch_pair(scene, shapes, pairs[i], tolerances); });
    return answers;
}

}  // namespace clinch::detail
