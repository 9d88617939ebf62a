#include "tests/narrow_phase/closed_form_oracle.hpp"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

namespace clinch::test {
namespace {

using boost::multiprecision::abs;
using boost::multiprecision::sqrt;
using std::max;
using std::min;

Exact dot(const Exact3& a, const Exact3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Exact3 plus(const Exact3& a, const Exact& s, const Exact3& b) {
    return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]};
}
Exact3 times(const Exact3& a, const Exact& s) {
    return {a[0] * s, a[1] * s, a[2] * s};
}
Exact3 minus(const Exact3& a, const Exact3& b) {
    return plus(a, Exact(-1), b);
}
Exact3 cross(const Exact3& a, const Exact3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Exact length(const Exact3& a) {
    return sqrt(dot(a, a));
}
Exact3 exact(const std::array<double, 3>& a) {
    return {Exact(a[0]), Exact(a[1]), Exact(a[2])};
}
Exact bounded(const Exact& x, const Exact& low, const Exact& high) {
    return max(low, min(high, x));
}

/// World to body.
Exact3 seen_from(const TrueBody& body, const Exact3& p) {
    const auto axis = axes(body);
    return {dot(axis[0], p), dot(axis[1], p), dot(axis[2], p)};
}

using Flat = std::array<Exact, 2>;

Exact from_stretch(const Flat& p, const Flat& a, const Flat& b) {
    const Exact dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
    const Exact t =
        square > 0 ? bounded(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / square, Exact(0), Exact(1)) : Exact(0);
    const Exact x = p[0] - a[0] - t * dx, y = p[1] - a[1] - t * dy;
    return sqrt(x * x + y * y);
}

/// Of a convex outline, counterclockwise.
Exact from_outline(const Flat& p, const std::vector<Flat>& outline, std::size_t open_edges) {
    bool inside = true;
    Exact least = -1;
    for (std::size_t i = 0; i + open_edges < outline.size(); ++i) {
        const Flat& a = outline[i];
        const Flat& b = outline[(i + 1) % outline.size()];
        if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) < 0) inside = false;
        const Exact d = from_stretch(p, a, b);
        if (least < 0 || d < least) least = d;
    }
    return inside ? Exact(-least) : least;
}

Exact segments_distance(const Exact3& p, const Exact3& u, const Exact& h, const Exact3& q, const Exact3& v,
                        const Exact& k) {
    const auto squared = [&](const Exact& s, const Exact& t) {
        const Exact3 d = minus(plus(q, t, v), plus(p, s, u));
        return dot(d, d);
    };
    const Exact3 r = minus(q, p);
    const Exact c = dot(u, v), ru = dot(r, u), rv = dot(r, v);
    Exact least = -1;
    const auto offer = [&](const Exact& s, const Exact& t) {
        const Exact d = squared(s, t);
        if (least < 0 || d < least) least = d;
    };
    for (const int side : {-1, 1}) {
        const Exact s = side * h, t = side * k;
        offer(s, bounded(s * c - rv, Exact(-k), k));
        offer(bounded(t * c + ru, Exact(-h), h), t);
    }
    const Exact sine = dot(cross(u, v), cross(u, v));
    if (sine > Exact("1e-60")) {
        const Exact s = (ru - c * rv) / sine, t = (c * ru - rv) / sine;
        if (abs(s) <= h && abs(t) <= k) offer(s, t);
    }
    return sqrt(least);
}

std::vector<Exact3> corners(const TrueBody& box) {
    const auto axis = axes(box);
    std::vector<Exact3> all;
    for (unsigned i = 0; i < 8; ++i) {
        Exact3 p = exact(box.position);
        for (unsigned d = 0; d < 3; ++d) p = plus(p, Exact((i >> d & 1u) != 0 ? box.size[d] : -box.size[d]), axis[d]);
        all.push_back(p);
    }
    return all;
}

/// Middles of the four edges along axis d.
std::vector<Exact3> edge_middles(const TrueBody& box, unsigned d) {
    const auto axis = axes(box);
    std::vector<Exact3> all;
    for (unsigned i = 0; i < 4; ++i) {
        const unsigned e = (d + 1) % 3, f = (d + 2) % 3;
        Exact3 p = plus(exact(box.position), Exact((i & 1u) != 0 ? box.size[e] : -box.size[e]), axis[e]);
        all.push_back(plus(p, Exact((i & 2u) != 0 ? box.size[f] : -box.size[f]), axis[f]));
    }
    return all;
}

Exact boxes_distance(const TrueBody& a, const TrueBody& b) {
    const auto axes_a = axes(a), axes_b = axes(b);
    std::vector<Exact3> directions(axes_a.begin(), axes_a.end());
    directions.insert(directions.end(), axes_b.begin(), axes_b.end());
    for (const Exact3& u : axes_a)
        for (const Exact3& v : axes_b) {
            const Exact3 n = cross(u, v);
            if (dot(n, n) > Exact("1e-50")) directions.push_back(n);
        }
    Exact deepest = -1e300;
    for (const Exact3& n : directions)
        deepest = max(deepest, max(parted_along(a, b, n), parted_along(a, b, times(n, Exact(-1)))));
    if (deepest <= 0) return deepest;
    Exact least = 1e300;
    for (const Exact3& p : corners(a)) least = min(least, from_surface(b, minus(p, exact(b.position))));
    for (const Exact3& p : corners(b)) least = min(least, from_surface(a, minus(p, exact(a.position))));
    for (unsigned i = 0; i < 3; ++i)
        for (unsigned j = 0; j < 3; ++j)
            for (const Exact3& p : edge_middles(a, i))
                for (const Exact3& q : edge_middles(b, j))
                    least =
                        min(least, segments_distance(p, axes_a[i], Exact(a.size[i]), q, axes_b[j], Exact(b.size[j])));
    return least;
}

/// How far a body reaches along n from its position.
Exact reach(const TrueBody& body, const Exact3& n) {
    const Exact3 m = seen_from(body, n);
    const Exact r = body.size[0], h = body.size[1], across = sqrt(m[0] * m[0] + m[1] * m[1]);
    switch (body.kind) {
        case Kind::sphere:
            return r * length(n);
        case Kind::box:
            return abs(m[0]) * body.size[0] + abs(m[1]) * body.size[1] + abs(m[2]) * body.size[2];
        case Kind::capsule:
            return r * length(n) + h * abs(m[2]);
        case Kind::cylinder:
            return r * across + h * abs(m[2]);
        case Kind::cone:
            return max(Exact(h * m[2]), Exact(r * across - h * m[2]));
        case Kind::hull: {
            Exact most = dot(exact(body.points.front()), m);
            for (const auto& p : body.points) most = max(most, dot(exact(p), m));
            return most;
        }
        case Kind::plane:
            break;
    }
    throw std::logic_error("a half-space reaches to infinity");
}

}  // namespace

std::array<Exact3, 3> axes(const TrueBody& body) {
    Exact w = body.rotation[0], x = body.rotation[1], y = body.rotation[2], z = body.rotation[3];
    const Exact norm = w * w + x * x + y * y + z * z;
    const Exact two = 2 / norm;
    return {{{1 - two * (y * y + z * z), two * (x * y + w * z), two * (x * z - w * y)},
             {two * (x * y - w * z), 1 - two * (x * x + z * z), two * (y * z + w * x)},
             {two * (x * z + w * y), two * (y * z - w * x), 1 - two * (x * x + y * y)}}};
}

std::array<Exact, 4> unit_plane(const TrueBody& plane) {
    const Exact3 n = exact(plane.normal);
    const Exact per = 1 / length(n);
    return {n[0] * per, n[1] * per, n[2] * per, Exact(plane.size[0]) * per};
}

Exact from_surface(const TrueBody& body, const Exact3& point) {
    const Exact3 p = seen_from(body, point);
    const Exact out = sqrt(p[0] * p[0] + p[1] * p[1]), r = body.size[0], h = body.size[1];
    switch (body.kind) {
        case Kind::sphere:
            return length(p) - r;
        case Kind::box: {
            Exact square = 0, most = -1e300;
            for (unsigned d = 0; d < 3; ++d) {
                const Exact past = abs(p[d]) - body.size[d];
                most = max(most, past);
                if (past > 0) square += past * past;
            }
            return most > 0 ? Exact(sqrt(square)) : most;
        }
        case Kind::capsule:
            return from_stretch({out, p[2]}, {Exact(0), Exact(-h)}, {Exact(0), h}) - r;
        case Kind::cylinder:
            return from_outline({out, p[2]}, {{Exact(0), Exact(-h)}, {r, Exact(-h)}, {r, h}, {Exact(0), h}}, 1);
        case Kind::cone:
            return from_outline({out, p[2]}, {{Exact(0), Exact(-h)}, {r, Exact(-h)}, {Exact(0), h}}, 1);
        case Kind::plane: {
            const auto plane = unit_plane(body);
            return plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2] - plane[3];
        }
        case Kind::hull:
            break;
    }
    throw std::logic_error("the surface of a hull is not known here");
}

Exact parted_along(const TrueBody& a, const TrueBody& b, const Exact3& n) {
    const Exact3 between = minus(exact(b.position), exact(a.position)), back = times(n, Exact(-1));
    return (dot(n, between) - reach(a, n) - reach(b, back)) / length(n);
}

Exact true_distance(const TrueBody& a, const TrueBody& b) {
    const Exact3 between = minus(exact(b.position), exact(a.position));
    if (a.kind == Kind::sphere) return from_surface(b, times(between, Exact(-1))) - a.size[0];
    if (a.kind == Kind::box && b.kind == Kind::box) return boxes_distance(a, b);
    if (a.kind == Kind::capsule && b.kind == Kind::capsule)
        return segments_distance({}, axes(a)[2], Exact(a.size[1]), between, axes(b)[2], Exact(b.size[1])) - a.size[0] -
               b.size[0];
    const bool first = a.kind == Kind::plane;
    const TrueBody& plane = first ? a : b;
    const TrueBody& body = first ? b : a;
    if (plane.kind != Kind::plane) throw std::logic_error("no oracle for this pair");
    const auto flat = unit_plane(plane);
    const auto axis = axes(plane);
    Exact3 up{};
    for (unsigned d = 0; d < 3; ++d) up = plus(up, flat[d], axis[d]);
    const Exact height = dot(up, minus(exact(body.position), exact(plane.position))) - flat[3];
    return height - reach(body, times(up, Exact(-1)));
}

}  // namespace clinch::test
