#include "tests/narrow_phase/polytope_oracle.hpp"

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>

namespace clinch::test {
namespace {

using Quad = boost::multiprecision::cpp_bin_float_quad;

template <class R>
struct Vector {
    R x, y, z;
    Vector operator+(const Vector& o) const { return {x + o.x, y + o.y, z + o.z}; }
    Vector operator-(const Vector& o) const { return {x - o.x, y - o.y, z - o.z}; }
    Vector operator*(const R& s) const { return {x * s, y * s, z * s}; }
    R dot(const Vector& o) const { return x * o.x + y * o.y + z * o.z; }
    Vector cross(const Vector& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
};

template <class R>
R length(const Vector<R>& v) {
    using std::sqrt;
    return sqrt(v.dot(v));
}

using Edge = std::pair<std::size_t, std::size_t>;
using Face = std::array<std::size_t, 3>;

template <class R>
struct Body {
    std::vector<Vector<R>> points;
    std::vector<Edge> edges;
    std::vector<Face> faces;
    std::vector<Vector<R>> normals;
};

// Relative to `base`, so that far from the world's origin nothing is lost.
template <class R>
std::vector<Vector<R>> in_world(const Polytope& p, const Vec3& base) {
    using std::sqrt;
    const R w0 = p.rotation.w, x0 = p.rotation.x, y0 = p.rotation.y, z0 = p.rotation.z;
    const R scale = R(1) / sqrt(R(w0 * w0 + x0 * x0 + y0 * y0 + z0 * z0));
    const R w = w0 * scale;
    const Vector<R> axis{x0 * scale, y0 * scale, z0 * scale};
    const Vector<R> at{R(p.position.x) - R(base.x), R(p.position.y) - R(base.y), R(p.position.z) - R(base.z)};
    std::vector<Vector<R>> points;
    for (const Vec3& q : p.points) {
        const Vector<R> v{R(q.x), R(q.y), R(q.z)}, t = axis.cross(v) * R(2);
        points.push_back(v + t * w + axis.cross(t) + at);
    }
    return points;
}

// Every triple that has all points on one side, to within far more than rounding: what is taken for a face and is none
// does no harm, for any direction gives a lower bound, and any triangle of points of the body an upper one.
template <class R>
void find_faces(Body<R>& body, double slack) {
    const auto& p = body.points;
    std::set<Edge> edges;
    for (std::size_t i = 0; i < p.size(); ++i)
        for (std::size_t j = i + 1; j < p.size(); ++j)
            for (std::size_t k = j + 1; k < p.size(); ++k) {
                const Vector<R> n = (p[j] - p[i]).cross(p[k] - p[i]);
                const R size = length(n);
                if (!(size > R(0))) continue;
                R high = 0, low = 0;
                for (const auto& q : p) {
                    const R d = n.dot(q - p[i]);
                    high = std::max(high, d);
                    low = std::min(low, d);
                }
                const bool top = high <= size * R(slack), bottom = -low <= size * R(slack);
                if (!top && !bottom) continue;
                body.faces.push_back({i, j, k});
                if (top) body.normals.push_back(n * (R(1) / size));
                if (bottom) body.normals.push_back(n * (R(-1) / size));
                edges.insert({i, j});
                edges.insert({j, k});
                edges.insert({i, k});
            }
    if (p.size() == 2) edges.insert({0, 1});
    body.edges.assign(edges.begin(), edges.end());
}

template <class R>
Body<R> body_of(const Polytope& p, const Vec3& base) {
    Body<R> body;
    body.points = in_world<R>(p, base);
    double size = 0;
    for (const Vec3& q : p.points) size = std::max({size, std::fabs(q.x), std::fabs(q.y), std::fabs(q.z)});
    find_faces(body, 1e-15 * size);
    return body;
}

// The lowest of b less the highest of a along n.
template <class R>
R separation(const Body<R>& a, const Body<R>& b, const Vector<R>& n) {
    R high = n.dot(a.points[0]), low = n.dot(b.points[0]);
    for (const auto& p : a.points) high = std::max(high, n.dot(p));
    for (const auto& p : b.points) low = std::min(low, n.dot(p));
    return low - high;
}

// The greatest separation among all directions that can be the best of overlapping bodies.
template <class R>
R best_axis(const Body<R>& a, const Body<R>& b) {
    R best = R(-1e300L);
    for (const auto& n : a.normals) best = std::max(best, separation(a, b, n));
    for (const auto& n : b.normals) best = std::max(best, separation(a, b, n * R(-1)));
    for (const Edge& e : a.edges)
        for (const Edge& f : b.edges) {
            const Vector<R> n = (a.points[e.second] - a.points[e.first]).cross(b.points[f.second] - b.points[f.first]);
            const R size = length(n);
            if (!(size > R(0))) continue;
            // The separations of n and -n, from one look.
            const Vector<R> unit = n * (R(1) / size);
            best = std::max({best, separation(a, b, unit), separation(a, b, unit * R(-1))});
        }
    return best;
}

template <class R>
R clamped(const R& x) {
    return x < R(0) ? R(0) : (x > R(1) ? R(1) : x);
}

template <class R>
R point_segment(const Vector<R>& p, const Vector<R>& a, const Vector<R>& b) {
    const Vector<R> e = b - a;
    const R ee = e.dot(e);
    const R t = ee > R(0) ? clamped<R>((p - a).dot(e) / ee) : R(0);
    return length<R>(a + e * t - p);
}

// Inside both segments the common perpendicular, else an end of one against the other.
template <class R>
R segment_segment(const Vector<R>& a, const Vector<R>& b, const Vector<R>& c, const Vector<R>& d) {
    R best = std::min(std::min(point_segment(a, c, d), point_segment(b, c, d)),
                      std::min(point_segment(c, a, b), point_segment(d, a, b)));
    const Vector<R> e = b - a, f = d - c, r = c - a, n = e.cross(f);
    const R nn = n.dot(n);
    if (!(nn > R(0))) return best;
    const R s = r.cross(f).dot(n) / nn, t = r.cross(e).dot(n) / nn;
    if (s >= R(0) && s <= R(1) && t >= R(0) && t <= R(1)) best = std::min<R>(best, length<R>(a + e * s - c - f * t));
    return best;
}

// Only where the foot is inside: elsewhere edges are nearer.
template <class R>
R point_triangle(const Vector<R>& p, const Vector<R>& a, const Vector<R>& b, const Vector<R>& c, const R& otherwise) {
    using std::abs;
    const Vector<R> n = (b - a).cross(c - a);
    const R nn = n.dot(n);
    const R u = (b - p).cross(c - p).dot(n), v = (c - p).cross(a - p).dot(n), w = (a - p).cross(b - p).dot(n);
    if (u < R(0) || v < R(0) || w < R(0)) return otherwise;
    using std::sqrt;
    return std::min<R>(otherwise, abs(R(n.dot(p - a))) / sqrt(nn));
}

template <class R>
R gap(const Body<R>& a, const Body<R>& b) {
    R best = R(1e300L);
    for (const auto& p : a.points)
        for (const auto& q : b.points) best = std::min(best, length<R>(p - q));
    for (const Edge& e : a.edges)
        for (const auto& q : b.points) best = std::min(best, point_segment(q, a.points[e.first], a.points[e.second]));
    for (const Edge& e : b.edges)
        for (const auto& q : a.points) best = std::min(best, point_segment(q, b.points[e.first], b.points[e.second]));
    for (const Edge& e : a.edges)
        for (const Edge& f : b.edges)
            best = std::min(
                best, segment_segment(a.points[e.first], a.points[e.second], b.points[f.first], b.points[f.second]));
    for (const Face& f : a.faces)
        for (const auto& q : b.points) best = point_triangle(q, a.points[f[0]], a.points[f[1]], a.points[f[2]], best);
    for (const Face& f : b.faces)
        for (const auto& q : a.points) best = point_triangle(q, b.points[f[0]], b.points[f[1]], b.points[f[2]], best);
    return best;
}

template <class R>
long double distance(const Polytope& a, const Polytope& b) {
    const Body<R> p = body_of<R>(a, a.position), q = body_of<R>(b, a.position);
    const R balls = R(a.ball) + R(b.ball);
    // Two bodies without faces have a difference without depth, and their axes say nothing.
    if (!p.faces.empty() || !q.faces.empty()) {
        const R axis = best_axis(p, q);
        if (axis <= R(0)) return static_cast<long double>(R(axis - balls));
    }
    return static_cast<long double>(R(gap(p, q) - balls));
}

}  // namespace

long double true_distance(const Polytope& a, const Polytope& b, bool careful) {
    return careful ? distance<Quad>(a, b) : distance<long double>(a, b);
}

}  // namespace clinch::test
