#include "src/narrow_phase/manifolds.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "src/device/quirks.hpp"
#include "src/narrow_phase/host_narrow.hpp"
#include "src/narrow_phase/matrix.hpp"
#include "src/narrow_phase/routines.hpp"
#include "src/scene/scene_impl.hpp"

namespace clinch::detail {
namespace host {
#include "cl/narrow_phase/manifold.clh"
}  // namespace host

namespace {

constexpr std::size_t contacts_worth_threads = 1024;
constexpr std::size_t point_columns = 5;  // OUT_COLUMNS of cl/narrow_phase/manifold.cl

// Numbers of vertices beyond what a name has room for come round again.
void put_in_order(ManifoldPoint* points, std::size_t count) {
    std::sort(points, points + count,
              [](const ManifoldPoint& p, const ManifoldPoint& q) { return p.feature < q.feature; });
    for (std::size_t i = 1; i < count; ++i)
        if (points[i].feature <= points[i - 1].feature) points[i].feature = points[i - 1].feature + 1;
}

// Makes room for the points of contacts that have so many each.
template <class CountOf>
void lay_out(ManifoldPoints& out, std::size_t contacts, const CountOf& count_of) {
    out.firsts.resize(contacts + 1);
    std::uint32_t total = 0;
    for (std::size_t i = 0; i < contacts; ++i) {
        out.firsts[i] = total;
        total += count_of(i);
    }
    out.firsts[contacts] = total;
    out.points.resize(total);
}

host::PatchBody patch_body(const Scene& scene, const NarrowShapes& shapes, std::uint32_t row) {
    const NarrowShape64& shape = shapes.records()[scene.impl().shape[row]];
    host::PatchBody body{};
    body.side = host_side(scene, shapes, row);
    body.kind = shape.kind;
    static_assert(sizeof(host::NarrowFace) == sizeof(NarrowFace64), "one layout");
    body.faces = reinterpret_cast<const host::NarrowFace*>(shapes.faces().data()) + shape.first_face;
    body.corners = shapes.corners().data();
    body.face_count = shape.face_count;
    return body;
}

host::Manifold manifold_of(const Scene& scene, const NarrowShapes& shapes, const HostAnswer& answer,
                           std::uint32_t wanted) {
    const Scene::Impl& s = scene.impl();
    host::PatchBody a = patch_body(scene, shapes, answer.a), b = patch_body(scene, shapes, answer.b);
    const Vec3 &p = s.position[answer.a], &q = s.position[answer.b];
    host::Manifold m{};
    m.normal = {answer.normal[0], answer.normal[1], answer.normal[2]};
    m.point = {answer.point[0], answer.point[1], answer.point[2]};
    m.distance = answer.distance;
    m.error = answer.error;
    m.limit = s.margin[answer.a] + s.margin[answer.b];
    m.wanted = wanted;
    host::find_manifold(&a, &b, {q.x - p.x, q.y - p.y, q.z - p.z}, &m);
    return m;
}

}  // namespace

bool Manifolds::can(const NarrowShapes& shapes, unsigned bits) const {
    if (bits == 64 && !device_.info().fp64) return false;
    const std::uint32_t most = most_loop_iterations(device_.info());
    if (most == std::numeric_limits<std::uint32_t>::max()) return true;
    // A contact looks at all corners of all faces, and at its edges four times over.
    for (const NarrowShape64& shape : shapes.records()) {
        std::uint64_t rounds = shape.vertex_count;
        for (std::uint32_t i = 0; i < shape.face_count; ++i) {
            const std::uint64_t corners = shapes.faces()[shape.first_face + i].corners;
            rounds += 1 + corners + 4 * corners * corners;
        }
        if (rounds > most / 4) return false;
    }
    return true;
}

void Manifolds::find(const NarrowScene& scene, const Slots& slots, std::uint32_t count, bool with_rests, unsigned bits,
                     std::uint32_t wanted, ManifoldPoints& out) {
    const DeviceInfo& info = device_.info();
    Kernel& kernel = kernels_[bits == 64 ? 1 : 0];
    if (!kernel)
        kernel =
            device_.kernel("narrow_phase/manifold", "find_manifolds", "-DPAIR_LANES=1" + number_defines(info, bits));
    stride_ = std::max<std::uint64_t>(stride_, count);
    device_.reserve(points_, stride_ * wanted * point_columns * (bits / 8), "the points of manifolds");
    device_.reserve(features_, stride_ * wanted * sizeof(std::uint32_t), "the features of manifolds");
    device_.reserve(counts_, stride_ * sizeof(std::uint32_t), "the counts of manifolds' points");
    // What nobody reads may be any buffer.
    const Buffer& margins = scene.has_margins() ? scene.margins() : scene.classes();
    const bool faces = scene.faces(bits).handle() != nullptr;
    const std::uint32_t most_items = info.compute_units * (info.lanes > 1 ? 16u : 65536u);
    const std::uint32_t per_item = (count - 1) / most_items + 1, items = (count - 1) / per_item + 1;
    kernel.args(slots.contacts(), slots.contact_stride(), with_rests ? 1u : 0u, count, per_item, scene.bodies(bits),
                scene.shapes(bits), scene.vertices(bits), faces ? scene.faces(bits) : scene.classes(),
                faces ? scene.corners(bits) : scene.classes(), margins, scene.has_margins() ? 1u : 0u, wanted, points_,
                features_, counts_, stride_);
    const std::size_t group = device_.group_size();
    device_.launch(kernel, (items + group - 1) / group, group);
    if (bits == 64)
        read<double>(count, wanted, out);
    else
        read<float>(count, wanted, out);
}

template <class Real>
void Manifolds::read(std::uint32_t count, std::uint32_t wanted, ManifoldPoints& out) {
    const Mapping counts = device_.map(counts_, count * sizeof(std::uint32_t));
    const Mapping points = device_.map(points_, stride_ * wanted * point_columns * sizeof(Real));
    const Mapping features = device_.map(features_, stride_ * wanted * sizeof(std::uint32_t));
    const auto* number = counts.as<std::uint32_t>();
    lay_out(out, count, [&](std::size_t i) { return number[i]; });
    const auto end = static_cast<std::ptrdiff_t>(count);
#pragma omp parallel for schedule(static) if (count >= contacts_worth_threads)
    for (std::ptrdiff_t c = 0; c < end; ++c) {
        const auto i = static_cast<std::size_t>(c);
        ManifoldPoint* const to = out.points.data() + out.firsts[i];
        for (std::size_t k = 0; k < number[i]; ++k) {
            const Real* const from = points.as<Real>() + k * point_columns * stride_ + i;
            const auto column = [&](std::size_t d) { return static_cast<double>(from[d * stride_]); };
            to[k] = {
                {column(0), column(1), column(2)}, column(3), column(4), features.as<std::uint32_t>()[k * stride_ + i]};
        }
        put_in_order(to, number[i]);
    }
}

void manifolds_on_host(const Scene& scene, const NarrowShapes& shapes, const std::vector<HostAnswer>& answers,
                       std::uint32_t wanted, ManifoldPoints& out) {
    std::vector<std::size_t> hits;
    for (std::size_t i = 0; i < answers.size(); ++i)
        if (answers[i].hit) hits.push_back(i);
    std::vector<host::Manifold> found(hits.size());
    const auto end = static_cast<std::ptrdiff_t>(hits.size());
#pragma omp parallel for schedule(dynamic, 64) if (hits.size() >= contacts_worth_threads)
    for (std::ptrdiff_t c = 0; c < end; ++c) {
        const auto i = static_cast<std::size_t>(c);
        found[i] = manifold_of(scene, shapes, answers[hits[i]], wanted);
    }
    lay_out(out, hits.size(), [&](std::size_t i) { return found[i].count; });
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const host::Manifold& m = found[i];
        ManifoldPoint* const to = out.points.data() + out.firsts[i];
        for (std::size_t k = 0; k < m.count; ++k)
            to[k] = {
                {m.on_a[k].x, m.on_a[k].y, m.on_a[k].z}, m.points[k].distance, m.points[k].error, m.points[k].feature};
        put_in_order(to, m.count);
    }
}

}  // namespace clinch::detail
