#include "src/narrow_phase/manifolds.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "src/device/quirks.hpp"
#include "src/narrow_phase/host_narrow.hpp"
#include "src/narrow_phase/matrix.hpp"
#include "src/narrow_phase/routines.hpp"
#include "src/primitives/host_parallel.hpp"
#include "src/scene/scene_impl.hpp"

namespace clinch::detail {
namespace host {
#include "cl/narrow_phase/manifold.clh"
#include "cl/narrow_phase/manifold_boxes.clh"
}  // namespace host

namespace {

constexpr std::size_t contacts_worth_threads = 1024;
constexpr std::size_t point_columns = 5;  // OUT_COLUMNS of cl/narrow_phase/manifold.cl

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

// A contact as both methods take it.
template <class Manifold>
Manifold manifold_of(const Scene::Impl& s, const HostAnswer& answer, std::uint32_t wanted) {
    Manifold m{};
    m.normal = {answer.normal[0], answer.normal[1], answer.normal[2]};
    m.point = {answer.point[0], answer.point[1], answer.point[2]};
    m.distance = answer.distance;
    m.error = answer.error;
    m.limit = s.margin[answer.a] + s.margin[answer.b];
    m.wanted = wanted;
    return m;
}

void add_point(FewPoints& to, const host::v3& on_a, double distance, double error, std::uint32_t feature) {
    to.points[to.count++] = {{on_a.x, on_a.y, on_a.z}, distance, error, feature};
}

FewPoints points_of_boxes(const Scene& scene, const NarrowShapes& shapes, const HostAnswer& answer,
                          const host::v3& between, std::uint32_t wanted) {
    const host::Side a = host_side(scene, shapes, answer.a), b = host_side(scene, shapes, answer.b);
    auto m = manifold_of<host::BoxManifold>(scene.impl(), answer, wanted);
    host::find_box_manifold(&a, &b, between, &m);
    FewPoints out;
    for (std::uint32_t k = 0; k < wanted; ++k) {
        if (!m.valid[k]) continue;
        const auto kind = static_cast<std::uint32_t>(m.kind[k]), of_a = static_cast<std::uint32_t>(m.of_a[k]),
                   of_b = static_cast<std::uint32_t>(m.of_b[k]);
        const std::uint32_t which = kind == 1 ? of_a : kind == 2 ? of_b : of_a << 15 | of_b;
        if (m.role[k] != 0.0) {
            out.deepest = out.count;
            out.is_witness = m.role[k] == 2.0;
        }
        add_point(out, m.on_a[k], m.along[k], m.off[k], kind == 0 ? 0 : kind << 30 | which);
    }
    return out;
}

FewPoints points_of(const Scene& scene, const NarrowShapes& shapes, const HostAnswer& answer, std::uint32_t wanted) {
    const Scene::Impl& s = scene.impl();
    const Vec3 &p = s.position[answer.a], &q = s.position[answer.b];
    const host::v3 between{q.x - p.x, q.y - p.y, q.z - p.z};
    host::PatchBody a = patch_body(scene, shapes, answer.a), b = patch_body(scene, shapes, answer.b);
    if (a.kind == box_class && b.kind == box_class) return points_of_boxes(scene, shapes, answer, between, wanted);
    auto m = manifold_of<host::Manifold>(s, answer, wanted);
    host::find_manifold(&a, &b, between, &m);
    FewPoints out;
    out.deepest = m.deepest;
    out.is_witness = m.is_witness;
    for (std::uint32_t k = 0; k < m.count; ++k)
        add_point(out, m.on_a[k], m.points[k].distance, m.points[k].error, m.points[k].feature);
    return out;
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

Kernel& Manifolds::kernel(std::size_t part, unsigned bits) {
    Kernel& kernel = kernels_[part][bits == 64 ? 1 : 0];
    if (!kernel)
        kernel = device_.kernel(parts[part].module, parts[part].kernel,
                                parts[part].defines + number_defines(device_.info(), bits));
    return kernel;
}

// Contacts a work-item looks at.
std::uint32_t Manifolds::per_item(std::uint32_t count) const {
    const DeviceInfo& info = device_.info();
    constexpr std::uint32_t block = Slots::block;
    const std::uint32_t most_items = info.compute_units * (info.lanes > 1 ? 16u : 65536u);
    return info.lanes > 1 ? ((count - 1) / most_items / block + 1) * block : (count - 1) / most_items + 1;
}

void Manifolds::find(const NarrowScene& scene, const Slots& slots, const ContactKinds& kinds, bool with_rests,
                     unsigned bits, std::uint32_t wanted, DevicePoints& out) {
    const auto boxes = static_cast<std::uint32_t>(kinds.boxes.size()),
               others = static_cast<std::uint32_t>(kinds.others.size());
    const std::uint64_t stride = std::max(stride_, column_stride(boxes + others));
    device_.reserve(points_, stride * wanted * point_columns * (bits / 8), "the points of manifolds");
    device_.reserve(features_, stride * wanted * sizeof(std::uint32_t), "the features of manifolds");
    device_.reserve(counts_, stride * sizeof(std::uint32_t), "the counts of manifolds' points");
    stride_ = stride;  // not sooner: a call that found no room is not to make the next ask for it
    // What nobody reads may be any buffer.
    const Buffer& margins = scene.has_margins() ? scene.margins() : scene.classes();
    const bool faces = scene.faces(bits).handle() != nullptr;
    const std::uint32_t with_margins = scene.has_margins() ? 1 : 0, rests = with_rests ? 1 : 0;
    const bool listed = boxes > 0 && others > 0;
    const auto run = [&](std::size_t part, const std::vector<std::uint32_t>& list, const auto&... data) {
        const auto count = static_cast<std::uint32_t>(list.size());
        if (count == 0) return;
        if (listed) {
            device_.reserve(lists_[part], count * sizeof(std::uint32_t), "the numbers of contacts");
            device_.write(lists_[part], list.data(), count * sizeof(std::uint32_t));
        }
        Kernel& find = kernel(part, bits);
        const std::uint32_t each = per_item(count), items = (count - 1) / each + 1;
        find.args(slots.contacts(), slots.contact_stride(), rests, listed ? lists_[part] : scene.classes(),
                  listed ? 1u : 0u, count, each, scene.bodies(bits), scene.shapes(bits), data..., margins, with_margins,
                  wanted, points_, features_, counts_, stride_);
        const std::size_t group = device_.group_size();
        device_.launch(find, (items + group - 1) / group, group);
    };
    run(0, kinds.boxes);
    run(1, kinds.others, scene.vertices(bits), faces ? scene.faces(bits) : scene.classes(),
        faces ? scene.corners(bits) : scene.classes());
    out.counts = device_.map(counts_, (boxes + others) * sizeof(std::uint32_t));
    out.points = device_.map(points_, stride_ * wanted * point_columns * (bits / 8));
    out.features = device_.map(features_, stride_ * wanted * sizeof(std::uint32_t));
    out.stride = stride_;
    out.bits = bits;
}

template <class Real>
void DevicePoints::read(std::size_t i, FewPoints& out) const {
    const std::uint32_t counted = counts.as<std::uint32_t>()[i];  // COUNTED of cl/narrow_phase/manifold_columns.clh
    out.count = counted & 255u;
    out.deepest = counted >> 8 & 255u;
    out.is_witness = counted >> 16 != 0;
    for (std::size_t k = 0; k < out.count; ++k) {
        const Real* const from = points.as<Real>() + k * point_columns * stride + i;
        const auto column = [&](std::size_t d) { return static_cast<double>(from[d * stride]); };
        out.points[k] = {
            {column(0), column(1), column(2)}, column(3), column(4), features.as<std::uint32_t>()[k * stride + i]};
    }
}

FewPoints DevicePoints::at(std::size_t i) const {
    FewPoints out;
    if (bits == 64)
        read<double>(i, out);
    else
        read<float>(i, out);
    return out;
}

std::vector<FewPoints> manifolds_on_host(const Scene& scene, const NarrowShapes& shapes,
                                         const std::vector<HostAnswer>& answers, std::uint32_t wanted) {
    std::vector<std::size_t> hits;
    for (std::size_t i = 0; i < answers.size(); ++i)
        if (answers[i].hit) hits.push_back(i);
    std::vector<FewPoints> found(hits.size());
    parallel_blocks(hits.size(), contacts_worth_threads,
                    [&](std::size_t i) { found[i] = points_of(scene, shapes, answers[hits[i]], wanted); });
    return found;
}

ContactKinds kinds_of(const Scene& scene, const NarrowShapes& shapes, const std::uint32_t* a, const std::uint32_t* b,
                      std::uint32_t count) {
    const std::vector<std::uint32_t>& shape = scene.impl().shape;
    const auto is_box = [&](std::uint32_t row) { return shapes.records()[shape[row]].kind == box_class; };
    ContactKinds kinds;
    for (std::uint32_t i = 0; i < count; ++i) (is_box(a[i]) && is_box(b[i]) ? kinds.boxes : kinds.others).push_back(i);
    return kinds;
}

}  // namespace clinch::detail
