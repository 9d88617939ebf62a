#include "tests/narrow_phase/convex_cases.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace clinch::test {
namespace {

using Real = long double;
using Real3 = std::array<Real, 3>;

std::array<double, 3> random_direction(Random& random) {
    for (;;) {
        const std::array<double, 3> v{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
        const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        if (length > 0.1 && length < 1.0) return {v[0] / length, v[1] / length, v[2] / length};
    }
}

Quat random_rotation_of(Random& random) {
    for (;;) {
        const Quat q{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
        const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
        if (length > 0.1 && length < 1.0) return {q.w / length, q.x / length, q.y / length, q.z / length};
    }
}

Quat product(const Quat& a, const Quat& b) {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

// To the world, or, inverse, to the body.
Real3 turned(const Quat& q, const Real3& v, bool inverse) {
    const Real length = std::sqrt(Real(q.w) * q.w + Real(q.x) * q.x + Real(q.y) * q.y + Real(q.z) * q.z);
    const Real sign = inverse ? -1 : 1, w = q.w / length;
    const Real3 u{sign * q.x / length, sign * q.y / length, sign * q.z / length};
    const auto cross = [](const Real3& a, const Real3& b) {
        return Real3{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    };
    const Real3 t = cross(u, v), s = cross(u, t);
    return {v[0] + 2 * (w * t[0] + s[0]), v[1] + 2 * (w * t[1] + s[1]), v[2] + 2 * (w * t[2] + s[2])};
}

// A cloud in a box or on a ball, or a prism with parallel faces and points that share planes.
std::vector<Vec3> random_points(const std::array<double, 3>& e, double size, Random& random) {
    const std::size_t count = 4 + random.below(9);
    const Vec3 at = random.below(3) != 0
                        ? Vec3{}
                        : Vec3{random.between(-size, size), random.between(-size, size), random.between(-size, size)};
    std::vector<Vec3> points;
    const std::uint64_t style = random.below(3);
    for (std::size_t i = 0; i < count; ++i) {
        std::array<double, 3> v = random_direction(random);
        if (style == 1) v = {random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
        if (style == 2) {
            const std::size_t sides = std::max<std::size_t>(3, count / 2);
            const double angle = 6.283185307179586 * static_cast<double>(i / 2 % sides) / static_cast<double>(sides);
            v = {std::cos(angle), std::sin(angle), i % 2 == 0 ? 1.0 : -1.0};
        }
        points.push_back({at.x + e[0] * v[0], at.y + e[1] * v[1], at.z + e[2] * v[2]});
    }
    if (style == 2)
        for (double z : {-1.0, 1.0}) points.push_back({at.x + e[0], at.y, at.z + z * e[2]});
    return points;
}

ConvexBody random_body(std::uint32_t kind, double size, double aspect, Random& random) {
    ConvexBody body;
    body.kind = kind;
    const auto length = [&] { return size * std::pow(aspect, -random.between(0, 1)); };
    if (kind == 6)
        body.points = random_points({length(), length(), length()}, size, random);
    else
        body.size = {length(), length(), length()};
    if (kind == 2 && random.below(6) == 0) body.size[1] = 0.0;
    body.rotation = random_rotation_of(random);
    return body;
}

// The two turned alike, or nearly, and moved along their axes: faces, edges and corners come to lie on each other.
void make_parallel(ConvexBodies& pair, double angle, Random& random) {
    if (random.below(2) == 0) pair.a.rotation = Quat{};
    std::array<double, 3> axis = random_direction(random);
    if (random.below(2) == 0) {
        axis = {};
        axis[random.below(3)] = 1.0;
    }
    const double s = std::sin(angle / 2);
    pair.b.rotation = product(pair.a.rotation, {std::cos(angle / 2), axis[0] * s, axis[1] * s, axis[2] * s});
    Real3 way{random.between(-2, 2), random.between(-2, 2), random.between(-2, 2)};
    for (int i = 0; i < 2; ++i)
        if (random.below(2) == 0) way[random.below(3)] = 0.0;
    if (pair.a.kind == 1 && pair.b.kind == 1 && random.below(2) == 0) {
        const std::size_t d = random.below(3);
        way[d] = pair.a.size[d] + pair.b.size[d];
        if (random.below(2) == 0) way[d] += std::pow(10.0, random.between(-12, -3)) * (random.below(2) == 0 ? 1 : -1);
    }
    const Real3 moved = turned(pair.a.rotation, way, false);
    pair.b.position = {static_cast<double>(moved[0]), static_cast<double>(moved[1]), static_cast<double>(moved[2])};
}

void scale(ConvexBody& body, double by) {
    for (double& x : body.size) x *= by;
    for (Vec3& p : body.points) p = {p.x * by, p.y * by, p.z * by};
    body.position = {body.position.x * by, body.position.y * by, body.position.z * by};
}

double reach_of(const ConvexBody& body) {
    double most = 0;
    for (const Vec3& p : body.points) most = std::max(most, std::hypot(p.x, p.y, p.z));
    if (body.kind == 0) return body.size[0];
    if (body.kind == 1) return std::hypot(body.size[0], body.size[1], body.size[2]);
    if (body.kind == 2) return body.size[0] + body.size[1];
    return body.kind == 6 ? most : std::hypot(body.size[0], body.size[1]);
}

// How far the body reaches from its position along n.
Real support(const ConvexBody& body, const Real3& n) {
    const Real3 m = turned(body.rotation, n, true);
    const Real across = std::sqrt(m[0] * m[0] + m[1] * m[1]), r = body.size[0], h = body.size[1];
    switch (body.kind) {
        case 0:
            return r * std::sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
        case 1:
            return std::fabs(m[0]) * r + std::fabs(m[1]) * h + std::fabs(m[2]) * body.size[2];
        case 2:
            return r * std::sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]) + h * std::fabs(m[2]);
        case 3:
            return r * across + h * std::fabs(m[2]);
        case 4:
            return std::max(h * m[2], r * across - h * m[2]);
        default: {
            Real most = -INFINITY;
            for (const Vec3& p : body.points) most = std::max(most, m[0] * p.x + m[1] * p.y + m[2] * p.z);
            return most;
        }
    }
}

void print(std::ostream& out, const ConvexBody& b) {
    out << "\n  kind " << b.kind << " size " << b.size[0] << ' ' << b.size[1] << ' ' << b.size[2] << " rotation "
        << b.rotation.w << ' ' << b.rotation.x << ' ' << b.rotation.y << ' ' << b.rotation.z << " position "
        << b.position.x << ' ' << b.position.y << ' ' << b.position.z << " points";
    for (const Vec3& p : b.points) out << " (" << p.x << ' ' << p.y << ' ' << p.z << ')';
}

}  // namespace

ConvexBodies random_bodies(std::uint32_t kind_a, std::uint32_t kind_b, Regime regime, Random& random) {
    const double ratio = regime == Regime::unequal ? std::pow(10.0, random.between(-5, 5)) : 1.0;
    const bool plain = regime == Regime::any || regime == Regime::far_scale;
    const double aspect = regime == Regime::flat ? 1e4 : (plain ? 4.0 : 1.0);
    ConvexBodies pair{random_body(kind_a, 1.0, aspect, random), random_body(kind_b, ratio, aspect, random)};
    double way = random.between(0, 1.8) * std::max(1.0, ratio);
    if (plain) way = random.between(0.1, 2.5);
    if (regime == Regime::concentric) way = 0;
    if (regime == Regime::nearly_concentric) way = std::pow(10.0, random.between(-12, -1));
    move(pair.b, random_direction(random), way);
    if (regime == Regime::parallel) make_parallel(pair, 0.0, random);
    if (regime == Regime::nearly_parallel) make_parallel(pair, std::pow(10.0, random.between(-9, -2)), random);
    const double far = random.below(2) == 0 ? 1e-30 : 1e12;
    if (regime == Regime::far_scale)
        for (ConvexBody* body : {&pair.a, &pair.b}) scale(*body, far);
    return pair;
}

void move(ConvexBody& b, const std::array<double, 3>& normal, double by) {
    b.position = {b.position.x + by * normal[0], b.position.y + by * normal[1], b.position.z + by * normal[2]};
}

double size_of(const ConvexBodies& pair) {
    const Vec3 &p = pair.a.position, &q = pair.b.position;
    return reach_of(pair.a) + reach_of(pair.b) + std::hypot(q.x - p.x, q.y - p.y, q.z - p.z);
}

Polytope polytope_of(const ConvexBody& body) {
    Polytope p{body.points, body.rotation, body.position, body.kind == 0 || body.kind == 2 ? body.size[0] : 0.0};
    if (body.kind == 0) p.points = {{}};
    if (body.kind == 2) p.points = {{0, 0, body.size[1]}, {0, 0, -body.size[1]}};
    if (body.kind == 2 && body.size[1] == 0.0) p.points.pop_back();
    if (body.kind == 1)
        for (unsigned i = 0; i < 8; ++i)
            p.points.push_back({(i & 1u) != 0 ? body.size[0] : -body.size[0],
                                (i & 2u) != 0 ? body.size[1] : -body.size[1],
                                (i & 4u) != 0 ? body.size[2] : -body.size[2]});
    return p;
}

long double separation(const ConvexBodies& pair, const std::array<long double, 3>& direction) {
    const Real length =
        std::sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
    const Real3 n{direction[0] / length, direction[1] / length, direction[2] / length};
    const Vec3 &p = pair.a.position, &q = pair.b.position;
    const Real way = n[0] * (Real(q.x) - p.x) + n[1] * (Real(q.y) - p.y) + n[2] * (Real(q.z) - p.z);
    return way - support(pair.a, n) - support(pair.b, {-n[0], -n[1], -n[2]});
}

long double best_separation(const ConvexBodies& pair, const std::array<double, 3>& start, Random& random) {
    Real3 n{start[0], start[1], start[2]};
    Real best = separation(pair, n);
    const auto look = [&](const Real3& m) {
        const Real s = separation(pair, m);
        if (!(s > best)) return false;
        best = s;
        n = m;
        return true;
    };
    for (int i = 0; i < 150; ++i) {
        const auto d = random_direction(random);
        look({d[0], d[1], d[2]});
    }
    Real step = 0.1L;
    for (int looks = 0, misses = 0; looks < 1500 && step > 1e-10L; ++looks) {
        const auto d = random_direction(random);
        if (look({n[0] + step * d[0], n[1] + step * d[1], n[2] + step * d[2]})) {
            step *= 1.5L;
            misses = 0;
            const Real length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
            for (Real& x : n) x /= length;
        } else if (++misses > 5) {
            step *= 0.5L;
            misses = 0;
        }
    }
    return best;
}

long double outside(const ConvexBody& body, const std::array<long double, 3>& p) {
    const Real3 m =
        turned(body.rotation, {p[0] - body.position.x, p[1] - body.position.y, p[2] - body.position.z}, true);
    const Real across = std::hypot(m[0], m[1]), r = body.size[0], h = body.size[1];
    const auto over = [](Real x) { return x > 0 ? x : Real(0); };
    if (body.kind == 0) return over(std::hypot(across, m[2]) - r);
    if (body.kind == 1) {
        const Real x = over(std::fabs(m[0]) - r), y = over(std::fabs(m[1]) - h),
                   z = over(std::fabs(m[2]) - body.size[2]);
        return std::sqrt(x * x + y * y + z * z);
    }
    if (body.kind == 2) return over(std::hypot(across, over(std::fabs(m[2]) - h)) - r);
    if (body.kind == 3) return std::hypot(over(across - r), over(std::fabs(m[2]) - h));
    // A cone: below its base, beside its slope, or inside.
    if (m[2] < -h) return std::hypot(over(across - r), -h - m[2]);
    const Real slope = std::hypot(r, 2 * h), off = (across * 2 * h + (m[2] - h) * r) / slope;
    const Real along = std::min(std::max((across * r - (m[2] - h) * 2 * h) / slope, Real(0)), slope);
    return off <= 0 ? 0 : std::hypot(across - along * r / slope, m[2] - h + along * 2 * h / slope);
}

std::string broken_promise(const ConvexBodies& pair, const ConvexAnswer& answer, double unit, double tolerance,
                           bool careful, Random& random) {
    const auto& n = answer.normal;
    const double size = size_of(pair);
    for (const double x :
         {answer.distance, answer.error, n[0], n[1], n[2], answer.point[0], answer.point[1], answer.point[2]})
        if (!std::isfinite(x)) return "not a number";
    if (std::fabs(std::hypot(n[0], n[1], n[2]) - 1.0) > 8 * unit) return "normal is not of unit length";
    std::ostringstream out;
    out.precision(17);
    const Real own = separation(pair, {n[0], n[1], n[2]});
    if (own < answer.distance - answer.error - 1.2 * tolerance * size)
        out << "distance " << answer.distance << " but along the normal " << own;
    if (is_curved(pair)) {
        // The greatest separation is the truth, and what is found of it no more than that.
        const Real least = best_separation(pair, n, random);
        if (least > answer.distance + answer.error) out << "distance " << answer.distance << " but apart by " << least;
    } else {
        const Real truth = true_distance(polytope_of(pair.a), polytope_of(pair.b), careful);
        if (!(std::fabs(answer.distance - truth) <= answer.error))
            out << "distance " << answer.distance << " is " << truth << ", error " << answer.error;
    }
    return out.str();
}

bool is_curved(const ConvexBodies& pair) {
    const auto curved = [](const ConvexBody& b) { return b.kind == 3 || b.kind == 4; };
    return curved(pair.a) || curved(pair.b);
}

long double witness_error(const ConvexBodies& pair, const ConvexAnswer& answer) {
    const Vec3& p = pair.a.position;
    const Real3 a{Real(p.x) + answer.point[0], Real(p.y) + answer.point[1], Real(p.z) + answer.point[2]};
    const Real d = answer.distance;
    const Real3 b{a[0] + d * answer.normal[0], a[1] + d * answer.normal[1], a[2] + d * answer.normal[2]};
    return std::max(pair.a.kind == 6 ? Real(0) : outside(pair.a, a), pair.b.kind == 6 ? Real(0) : outside(pair.b, b));
}

std::string text_of(const ConvexBodies& pair) {
    std::ostringstream out;
    out.precision(17);
    print(out, pair.a);
    print(out, pair.b);
    return out.str();
}

}  // namespace clinch::test
