#include <algorithm>
#include <cmath>
#include <cstddef>
#include <variant>

#include "tests/narrow_phase/campaign_oracle.hpp"

namespace clinch::test::campaign {
namespace {

// Squares of numbers from 1e-300 to 1e300 are far from the ends of what a long double of 15 exponent bits can hold, so
// only directions, which may be denormal doubles' differences, are brought to 1 first.
Real largest(const Real3& v) {
    return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

Real3 exact(const Vec3& v) {
    return {v.x, v.y, v.z};
}

struct FillForm {
    Form& form;

    void box_of(const Vec3& e) const {
        const Real h[3] = {e.x, e.y, e.z};
        for (std::size_t d = 0; d < 3; ++d) {
            const Real3 axis{d == 0 ? 1.0L : 0, d == 1 ? 1.0L : 0, d == 2 ? 1.0L : 0};
            form.edges.push_back(axis);
            for (const Real sign : {1.0L, -1.0L}) {
                form.normals.push_back(axis * sign);
                form.heights.push_back(h[d]);
            }
        }
    }
    void operator()(const Sphere& s) const { form.size[0] = form.ball = form.reach = s.radius; }
    void operator()(const Box& s) const {
        form.size = {s.half_extents.x, s.half_extents.y, s.half_extents.z};
        form.reach = static_cast<double>(length(exact(s.half_extents)));
        box_of(s.half_extents);
    }
    void operator()(const Capsule& s) const {
        form.size = {s.radius, s.half_height, 0};
        form.ball = s.radius;
        form.reach = s.radius + s.half_height;
        form.edges.push_back({0, 0, 1});
    }
    void operator()(const Cylinder& s) const { round(s.radius, s.half_height); }
    void operator()(const Cone& s) const { round(s.radius, s.half_height); }
    void round(double radius, double half_height) const {
        form.size = {radius, half_height, 0};
        form.reach = static_cast<double>(length({radius, half_height, 0}));
    }
    void operator()(const Plane& s) const {
        const Real long_normal = length(exact(s.normal));
        form.normals.push_back(unit(exact(s.normal)));
        form.heights.push_back(Real(s.offset) / long_normal);
        form.reach = std::fabs(static_cast<double>(form.heights[0]));
    }
    void operator()(const Hull& s) const {
        for (const Vec3& p : s.points) {
            form.points.push_back({p.x, p.y, p.z});
            form.reach = std::max(form.reach, static_cast<double>(length(exact(p))));
        }
        for (const auto& p : form.points)
            form.middle = form.middle + p.as<Real>() * (Real(1) / static_cast<Real>(form.points.size()));
        find_faces();
        find_edges();
    }
    void operator()(const Mesh&) const {}

    struct Triple {
        std::size_t corner[3];
        Real3 normal;
        Real area, blur;
    };

    // Every triple with all points on one side, the largest of each plane.
    void find_faces() const {
        const auto& p = form.points;
        std::vector<Triple> triples;
        for (std::size_t i = 0; i < p.size(); ++i)
            for (std::size_t j = i + 1; j < p.size(); ++j)
                for (std::size_t k = j + 1; k < p.size(); ++k) offer_face(i, j, k, triples);
        std::sort(triples.begin(), triples.end(), [](const Triple& s, const Triple& t) { return s.area > t.area; });
        for (const Triple& t : triples) {
            const Real height = t.normal.dot(p[t.corner[0]].as<Real>());
            bool known = false;
            for (std::size_t f = 0; f < form.normals.size() && !known; ++f) {
                known = form.normals[f].dot(t.normal) > 0;
                for (const std::size_t c : t.corner)
                    known = known && std::fabs(form.normals[f].dot(p[c].as<Real>()) - form.heights[f]) <= flat();
            }
            if (known) continue;
            form.normals.push_back(t.normal);
            form.heights.push_back(height);
            form.blur = std::max(form.blur, t.blur);
        }
    }
    Real flat() const { return 4e-18L * form.reach; }
    void offer_face(std::size_t i, std::size_t j, std::size_t k, std::vector<Triple>& triples) const {
        const auto& p = form.points;
        const Real3 o = p[i].as<Real>(), e = p[j].as<Real>() - o, f = p[k].as<Real>() - o;
        const Real3 n = unit(e).cross(unit(f));
        const Real sine = length(n);
        if (!(sine > 1e-17L)) return;
        const Real3 m = n * (1 / sine);
        Real high = 0, low = 0;
        for (const auto& q : p) {
            const Real d = m.dot(q.as<Real>() - o);
            high = std::max(high, d);
            low = std::min(low, d);
        }
        const Real area = sine * length(e) * length(f), blur = 1e-19L / sine;
        if (high <= flat()) triples.push_back({{i, j, k}, m, area, blur});
        if (-low <= flat()) triples.push_back({{i, j, k}, -m, area, blur});
    }
    // Every pair of points that lie on two faces.
    void find_edges() const {
        const auto& p = form.points;
        for (std::size_t i = 0; i < p.size(); ++i)
            for (std::size_t j = i + 1; j < p.size(); ++j) {
                const Real3 u = p[i].as<Real>(), v = p[j].as<Real>();
                int on = 0;
                for (std::size_t f = 0; f < form.normals.size(); ++f)
                    on += std::fabs(form.normals[f].dot(u) - form.heights[f]) <= flat() &&
                                  std::fabs(form.normals[f].dot(v) - form.heights[f]) <= flat()
                              ? 1
                              : 0;
                if (on < 2 || !(largest(v - u) > 0)) continue;
                const Real3 e = unit(v - u);
                const auto same = [&](const Real3& k) { return length(k.cross(e)) <= 1e-19L; };
                if (std::none_of(form.edges.begin(), form.edges.end(), same)) form.edges.push_back(e);
            }
    }
};

}  // namespace

Real length(const Real3& v) {
    return std::sqrt(v.dot(v));
}

Real3 unit(const Real3& v) {
    const Real most = largest(v);
    if (!(most > 0)) return {0, 0, 1};
    const Real3 w = v * (1 / most);
    return w * (1 / length(w));
}

Form form_of(const Shape& shape) {
    Form form;
    form.shape = shape;
    form.kind = shape.index();
    std::visit(FillForm{form}, shape);
    return form;
}

}  // namespace clinch::test::campaign
