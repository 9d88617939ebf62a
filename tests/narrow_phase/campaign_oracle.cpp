#include "tests/narrow_phase/campaign_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace clinch::test::campaign {
namespace {

constexpr Real infinite = std::numeric_limits<Real>::infinity();

Real over(Real x) {
    return x > 0 ? x : Real(0);
}

Real3 exact(const Vec3& v) {
    return {v.x, v.y, v.z};
}

// The two numbers as those of a half plane: the distance of p from the stretch a b.
Real from_stretch(Real x, Real y, Real ax, Real ay, Real bx, Real by) {
    const Real dx = bx - ax, dy = by - ay, square = dx * dx + dy * dy;
    const Real t = square > 0 ? std::clamp(((x - ax) * dx + (y - ay) * dy) / square, Real(0), Real(1)) : Real(0);
    return std::hypot(x - ax - t * dx, y - ay - t * dy);
}

// Signed distance of a point in the body's frame from the surface of a body that is no hull; negative inside.
Real from_surface(const Form& form, const Real3& p) {
    const Real across = std::hypot(p.x, p.y), r = form.size[0], h = form.size[1];
    switch (form.kind) {
        case sphere:
            return length(p) - r;
        case box: {
            const Real x = std::fabs(p.x) - r, y = std::fabs(p.y) - h, z = std::fabs(p.z) - form.size[2];
            const Real most = std::max({x, y, z});
            return most > 0 ? length({over(x), over(y), over(z)}) : most;
        }
        case capsule:
            return std::hypot(across, over(std::fabs(p.z) - h)) - r;
        case cylinder: {
            const Real side = across - r, cap = std::fabs(p.z) - h, most = std::max(side, cap);
            return most > 0 ? std::hypot(over(side), over(cap)) : most;
        }
        default: {  // a cone
            const Real base = from_stretch(across, p.z, 0, -h, r, -h), slant = from_stretch(across, p.z, r, -h, 0, h);
            // Inside: above the base and below the slant's line.
            const bool inside = p.z >= -h && across * (2 * h) + (p.z - h) * r <= 0;
            return inside ? -std::min(base, slant) : std::min(base, slant);
        }
    }
}

Real segments_distance(const Real3& way, const Real3& u, Real h, const Real3& v, Real k) {
    const auto apart = [&](Real s, Real t) { return length(way + v * t - u * s); };
    const Real c = u.dot(v), ru = way.dot(u), rv = way.dot(v);
    Real least = infinite;
    for (const Real side : {-1.0L, 1.0L}) {
        least = std::min(least, apart(side * h, std::clamp(side * h * c - rv, -k, k)));
        least = std::min(least, apart(std::clamp(side * k * c + ru, -h, h), side * k));
    }
    const Real3 n = u.cross(v);
    const Real sine = n.dot(n);
    if (sine > 0) {
        // Each time from the last feet, where the way is short and rounding small.
        Real s = 0, t = 0;
        for (int i = 0; i < 4; ++i) {
            const Real3 rest = way + v * t - u * s;
            s = std::clamp(s + rest.cross(v).dot(n) / sine, -h, h);
            t = std::clamp(s * c - rv, -k, k);
            s = std::clamp(t * c + ru, -h, h);
            least = std::min(least, apart(s, t));
        }
    }
    return least;
}

// Of a hull. A point outside is drawn towards a point within until no face's plane parts it from the hull.
Real outside_faces(const Form& form, const Real3& p) {
    const Real3 way = p - form.middle;
    Real part = 1;
    for (std::size_t f = 0; f < form.normals.size(); ++f) {
        const Real along = form.normals[f].dot(way), room = form.heights[f] - form.normals[f].dot(form.middle);
        if (along > room) part = std::min(part, over(room) / along);
    }
    return (1 - part) * length(way);
}

// How far the core reaches along n from the body's position, and where.
template <class R>
R core_reach(const Posed<R>& body, const Vector<R>& n, Vector<R>* where = nullptr) {
    const Form& form = *body.form;
    const Vector<R> m = body.turned_back(n);
    const R r = static_cast<R>(form.size[0]), h = static_cast<R>(form.size[1]);
    Vector<R> p;
    switch (form.kind) {
        case sphere:
            break;
        case box:
            p = {std::copysign(r, m.x), std::copysign(h, m.y), std::copysign(static_cast<R>(form.size[2]), m.z)};
            break;
        case capsule:
            p = {0, 0, std::copysign(h, m.z)};
            break;
        case hull: {
            R most = -std::numeric_limits<R>::infinity();
            for (const auto& q : form.points) {
                const R d = m.x * static_cast<R>(q.x) + m.y * static_cast<R>(q.y) + m.z * static_cast<R>(q.z);
                if (!(d > most)) continue;
                most = d;
                p = q.template as<R>();
            }
            break;
        }
        default: {
            const R across = std::sqrt(m.x * m.x + m.y * m.y), per = across > 0 ? r / across : R(0);
            p = {m.x * per, m.y * per, form.kind == cone ? -h : std::copysign(h, m.z)};
            if (form.kind == cone && h * m.z >= m.x * p.x + m.y * p.y - h * m.z) p = {0, 0, h};
        }
    }
    if (where != nullptr) *where = body.turned(p);
    return m.dot(p);
}

template <class R>
Posed<R> rounded(const Posed<Real>& body) {
    Posed<R> out;
    out.form = body.form;
    for (std::size_t i = 0; i < 9; ++i) out.turn[i] = static_cast<R>(body.turn[i]);
    out.at = body.at.as<R>();
    return out;
}

PosedPair swapped(const PosedPair& pair) {
    PosedPair other{pair.b, pair.a, pair.size};
    other.b.at = -pair.b.at;
    other.a.at = {};
    return other;
}

// Where the closed formulas say all; a's class is not above b's.
bool closed_form(const PosedPair& pair, Real* distance) {
    const Form &a = *pair.a.form, &b = *pair.b.form;
    if (a.kind == plane) {  // and a hull: the half-space is the first
        const Real3 up = pair.a.turned(a.normals[0]);
        *distance = up.dot(pair.b.at) - core_reach(pair.b, -up) - a.heights[0];
        return true;
    }
    if (b.kind == plane) {
        const Real3 up = pair.b.turned(b.normals[0]);
        *distance = -up.dot(pair.b.at) - core_reach(pair.a, -up) - a.ball - b.heights[0];
        return true;
    }
    if (a.kind == sphere && b.kind != hull) {
        *distance = from_surface(b, pair.b.turned_back(-pair.b.at)) - a.size[0];
        return true;
    }
    if (a.kind == capsule && b.kind == capsule) {
        *distance =
            segments_distance(pair.b.at, pair.a.axis(2), a.size[1], pair.b.axis(2), b.size[1]) - a.ball - b.ball;
        return true;
    }
    return false;
}

bool is_polytope(const Form& form) {
    return form.kind != cylinder && form.kind != cone && form.kind != plane;
}

// A search over directions, in double, of which the best are looked at once more in long double.
class Search {
public:
    explicit Search(const PosedPair& pair)
        : pair_(pair),
          a_(rounded<double>(pair.a)),
          b_(rounded<double>(pair.b)),
          balls_(pair.a.form->ball + pair.b.form->ball) {}

    void offer(const Vector<double>& n) { offer(n, nullptr); }
    // As above, and the point of the cores' difference that is lowest along n.
    void offer(const Vector<double>& n, Vector<double>* lowest) {
        Vector<double> p, q;
        const double f = n.dot(b_.at) - core_reach(a_, n, lowest != nullptr ? &p : nullptr) -
                         core_reach(b_, -n, lowest != nullptr ? &q : nullptr) - balls_;
        if (lowest != nullptr) *lowest = b_.at + q - p;
        if (f > value_) {
            second_ = best_;
            best_ = n;
            value_ = f;
        }
    }
    // The exact bound along n.
    void sure(const Real3& n) {
        const Real3 m = unit(n);
        const Real f = parted_along(pair_, m);
        if (!(f > low_)) return;
        low_ = f;
        low_at_ = m;
    }
    // From the best direction: planes through what is lowest around it, at ever smaller angles.
    void climb(Random& random) {
        for (const double angle : {0.5, 0.05, 1e-3, 1e-5, 1e-7}) {
            const Vector<double> n = best_;
            const Vector<double> x = across(n), y = n.cross(x);
            const double turn = random.between(0, 6.283185307179586);
            Vector<double> w[3];
            for (int i = 0; i < 3; ++i) {
                const double t = turn + 2.0943951023931953 * i;
                offer(scaled(n + x * (angle * std::cos(t)) + y * (angle * std::sin(t))), &w[i]);
            }
            const Vector<double> m = scaled((w[1] - w[0]).cross(w[2] - w[0]));
            offer(m);
            offer(-m);
        }
    }
    Bracket answer() {
        sure(best_.as<Real>());
        sure(second_.as<Real>());
        return {low_, infinite, low_at_};
    }

private:
    static Vector<double> scaled(const Vector<double>& v) { return unit(v.as<Real>()).as<double>(); }
    static Vector<double> across(const Vector<double>& n) {
        return scaled(std::fabs(n.x) < 0.6 ? Vector<double>{0, -n.z, n.y} : Vector<double>{n.z, 0, -n.x});
    }

    const PosedPair& pair_;
    Posed<double> a_, b_;
    double balls_;
    Vector<double> best_{0, 0, 1}, second_{0, 0, 1};
    double value_ = -std::numeric_limits<double>::infinity();
    Real low_ = -infinite;
    Real3 low_at_;
};

// All axes that can part polytopes (or, of swept ones, their cores). Returns how far rounding and axes that are all but
// one may have left the greatest from the truth; negative: there were too many to look at.
Real offer_axes(const PosedPair& pair, bool thorough, Search& search) {
    const Form &a = *pair.a.form, &b = *pair.b.form;
    const std::size_t crosses = a.edges.size() * b.edges.size();
    if (!thorough && crosses + a.normals.size() + b.normals.size() > 60) return -1;
    for (const Real3& n : a.normals) search.offer(pair.a.turned(n).as<double>());
    for (const Real3& n : b.normals) search.offer((-pair.b.turned(n)).as<double>());
    Real open = 0;
    std::vector<Real3> others;
    for (const Real3& f : b.edges) others.push_back(pair.b.turned(f));
    for (const Real3& e : a.edges) {
        const Real3 u = pair.a.turned(e);
        for (const Real3& v : others) {
            const Real3 n = u.cross(v);
            const Real sine = std::sqrt(n.dot(n));
            open = std::max(open, std::min(1e-18L / sine, 4 * sine));
            if (!(sine > 1e-19L)) continue;
            const Vector<double> m = (n * (1 / sine)).as<double>();
            search.offer(m);
            search.offer(-m);
        }
    }
    // The axes were looked at in double.
    return open + 4 * (a.blur + b.blur) + 4e-16L;
}

}  // namespace

PosedPair posed(const CampaignBody& a, const CampaignBody& b) {
    const auto turn_of = [](const Quat& q) {
        const Real w = q.w, x = q.x, y = q.y, z = q.z, s = 2 / (w * w + x * x + y * y + z * z);
        return std::array<Real, 9>{1 - s * (y * y + z * z), s * (x * y - w * z),     s * (x * z + w * y),
                                   s * (x * y + w * z),     1 - s * (x * x + z * z), s * (y * z - w * x),
                                   s * (x * z - w * y),     s * (y * z + w * x),     1 - s * (x * x + y * y)};
    };
    PosedPair pair;
    pair.a = {a.form, turn_of(a.rotation), {}};
    pair.b = {b.form, turn_of(b.rotation), exact(b.position) - exact(a.position)};
    pair.size = Real(a.form->reach) + b.form->reach + length(pair.b.at);
    return pair;
}

template <class R>
Vector<R> farthest(const Posed<R>& body, const Vector<R>& n) {
    Vector<R> p;
    core_reach(body, n, &p);
    return p;
}
template Vector<Real> farthest(const Posed<Real>& body, const Vector<Real>& n);

Real parted_along(const PosedPair& pair, const Real3& n) {
    if (pair.a.form->kind == plane || pair.b.form->kind == plane) {
        const bool first = pair.a.form->kind == plane;
        const Posed<Real>& half_space = first ? pair.a : pair.b;
        const Posed<Real>& body = first ? pair.b : pair.a;
        const Real3 toward = first ? n : -n;  // out of the half-space
        const Real way = toward.dot(first ? pair.b.at : -pair.b.at);
        return way - core_reach(body, -toward) - body.form->ball - half_space.form->heights[0];
    }
    return n.dot(pair.b.at) - core_reach(pair.a, n) - core_reach(pair.b, -n) - pair.a.form->ball - pair.b.form->ball;
}

Real beyond_faces(const Posed<Real>& hull, const Real3& point) {
    const Form& form = *hull.form;
    const Real3 p = hull.turned_back(point - hull.at);
    Real most = 0;
    for (std::size_t f = 0; f < form.normals.size(); ++f)
        most = std::max(most, form.normals[f].dot(p) - form.heights[f]);
    return most;
}

Real outside_core(const Posed<Real>& body, const Real3& point) {
    const Form& form = *body.form;
    const Real3 p = body.turned_back(point - body.at);
    if (form.kind == sphere) return length(p);
    if (form.kind == capsule) return length({p.x, p.y, over(std::fabs(p.z) - form.size[1])});
    if (form.kind != hull && form.kind != plane) return over(from_surface(form, p));
    return outside_faces(form, p);
}

Real proved_by_points(const PosedPair& pair, const Real3& on_a, const Real3& on_b, const Real3& n) {
    const Real3 p = on_a - n * pair.a.form->ball, q = on_b + n * pair.b.form->ball;
    return length(q - p) + outside_core(pair.a, p) + outside_core(pair.b, q) - pair.a.form->ball - pair.b.form->ball;
}

Bracket bracket_of(const PosedPair& pair, const std::vector<Real3>& hints, bool thorough, Random& random) {
    const Form &a = *pair.a.form, &b = *pair.b.form;
    if (a.kind > b.kind) {
        std::vector<Real3> turned_round;
        for (const Real3& n : hints) turned_round.push_back(-n);
        Bracket bracket = bracket_of(swapped(pair), turned_round, thorough, random);
        bracket.best = -bracket.best;
        return bracket;
    }
    Bracket bracket;
    if (closed_form(pair, &bracket.low)) {
        bracket.high = bracket.low;
        return bracket;
    }
    Search search(pair);
    for (const Real3& n : hints) {
        search.sure(n);
        search.offer(n.as<double>());
    }
    search.offer(unit(pair.b.at).as<double>());
    const bool axes = is_polytope(a) && is_polytope(b);
    const Real open = axes ? offer_axes(pair, thorough, search) : Real(-1);
    if (open >= 0) {
        bracket = search.answer();
        const Real balls = Real(a.ball) + b.ball;
        // The cores overlap: the best axis is the truth. Else a gap's direction need be no axis, unless it is found.
        if (bracket.low + balls <= 0) {
            bracket.high = bracket.low + open * pair.size;
            return bracket;
        }
    }
    for (std::size_t i = 0; i < 3 && !axes; ++i) {
        for (const Real3& n : {pair.a.axis(i), pair.b.axis(i)}) {
            search.offer(n.as<double>());
            search.offer((-n).as<double>());
        }
    }
    for (int i = 0; i < 6; ++i) {
        const Real3 n{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
        search.offer(unit(n).as<double>());
    }
    search.climb(random);
    return search.answer();
}

}  // namespace clinch::test::campaign
