#include "bench/peers/narrow/hull_faces.hpp"

#include <libqhull_r/qhull_ra.h>

#include <cstdio>
#include <memory>
#include <set>
#include <stdexcept>

namespace clinch::peers::narrow {
namespace {

struct Free {
    void operator()(qhT* qh) const {
        qh_freeqhull(qh, qh_ALL);
        int blocks = 0, bytes = 0;
        qh_memfreeshort(qh, &blocks, &bytes);
        const std::default_delete<qhT> last;
        last(qh);
    }
};

double volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Vec3 u{b.x - a.x, b.y - a.y, b.z - a.z}, v{c.x - a.x, c.y - a.y, c.z - a.z},
        w{d.x - a.x, d.y - a.y, d.z - a.z};
    return u.x * (v.y * w.z - v.z * w.y) + u.y * (v.z * w.x - v.x * w.z) + u.z * (v.x * w.y - v.y * w.x);
}

Vec3 middle(const std::vector<Vec3>& points) {
    Vec3 sum;
    for (const Vec3& p : points) sum = {sum.x + p.x, sum.y + p.y, sum.z + p.z};
    const auto n = static_cast<double>(points.size());
    return {sum.x / n, sum.y / n, sum.z / n};
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> hull_faces(const std::vector<Vec3>& points) {
    std::vector<coordT> coordinates;
    for (const Vec3& p : points) coordinates.insert(coordinates.end(), {p.x, p.y, p.z});
    const std::unique_ptr<qhT, Free> qhull(std::make_unique<qhT>().release());
    qhT* qh = qhull.get();
    qh_zero(qh, stderr);
    char options[] = "qhull Qt Pp";
    if (qh_new_qhull(qh, 3, static_cast<int>(points.size()), coordinates.data(), False, options, nullptr, nullptr) != 0)
        throw std::runtime_error("Qhull makes no hull of these points");
    const Vec3 inside = middle(points);
    std::vector<std::array<std::uint32_t, 3>> faces;
    std::set<std::uint32_t> corners;
    for (facetT* facet = qh->facet_list; facet != nullptr && facet->next != nullptr; facet = facet->next) {
        std::array<std::uint32_t, 3> face{};
        for (int i = 0; i < 3; ++i) {
            const auto* const vertex = static_cast<const vertexT*>(facet->vertices->e[i].p);
            face[static_cast<std::size_t>(i)] = static_cast<std::uint32_t>(qh_pointid(qh, vertex->point));
        }
        if (volume(points[face[0]], points[face[1]], points[face[2]], inside) > 0.0) std::swap(face[1], face[2]);
        corners.insert(face.begin(), face.end());
        faces.push_back(face);
    }
    if (corners.size() != points.size()) throw std::runtime_error("a point is no corner of the hull");
    return faces;
}

}  // namespace clinch::peers::narrow
