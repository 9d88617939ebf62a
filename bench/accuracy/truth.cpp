#include "bench/accuracy/truth.hpp"

#include <algorithm>
#include <cmath>

#include "tests/narrow_phase/polytope_oracle.hpp"

namespace clinch::accuracy {
namespace {

using test::Kind;
using test::TrueBody;
using test::TruePair;

bool has_closed_form(Kind a, Kind b) {
    const auto& pairs = test::closed_form_pairs();
    return std::find(pairs.begin(), pairs.end(), std::array<Kind, 2>{a, b}) != pairs.end();
}

bool is_round(Kind kind) {
    return kind == Kind::cylinder || kind == Kind::cone;
}

test::Polytope polytope_of(const TrueBody& body) {
    test::Polytope p;
    const auto& r = body.rotation;
    p.rotation = {r[0], r[1], r[2], r[3]};
    p.position = {body.position[0], body.position[1], body.position[2]};
    const auto& s = body.size;
    if (body.kind == Kind::sphere || body.kind == Kind::capsule) p.ball = s[0];
    if (body.kind == Kind::sphere) p.points = {{}};
    if (body.kind == Kind::capsule) p.points = {{0, 0, s[1]}, {0, 0, -s[1]}};
    if (body.kind == Kind::box)
        for (unsigned i = 0; i < 8; ++i)
            p.points.push_back(
                {(i & 1u) != 0 ? s[0] : -s[0], (i & 2u) != 0 ? s[1] : -s[1], (i & 4u) != 0 ? s[2] : -s[2]});
    for (const auto& q : body.points) p.points.push_back({q[0], q[1], q[2]});
    return p;
}

constexpr std::size_t most_vertices = 24;

bool can_be_enumerated(const TruePair& pair) {
    return !is_round(pair.a.kind) && !is_round(pair.b.kind) &&
           polytope_of(pair.a).points.size() + polytope_of(pair.b).points.size() <= most_vertices;
}

bool is_plane(const TrueBody& body) {
    return body.kind == Kind::plane;
}

}  // namespace

std::string text_of(Source source) {
    switch (source) {
        case Source::closed_form:
            return "closed form, 113 bits";
        case Source::enumeration:
            return "enumeration of features, 64 bits";
        default:
            return "search over directions by a growing hull, 64 bits";
    }
}

bool has_volume(Kind a, Kind b) {
    const auto flat = [](Kind k) { return k == Kind::sphere || k == Kind::capsule; };
    return a != Kind::plane && b != Kind::plane && !(flat(a) && flat(b));
}

Truth truth_of(const TruePair& pair, bool nearly_parallel) {
    const bool bounded = has_volume(pair.a.kind, pair.b.kind);
    Bounds bounds;
    if (bounded) bounds = bounds_of(Difference(pair));
    Truth truth;
    if (has_closed_form(pair.a.kind, pair.b.kind)) {
        truth.low = truth.high = static_cast<Real>(test::true_distance(pair.a, pair.b));
    } else if (!nearly_parallel && can_be_enumerated(pair)) {
        truth.source = Source::enumeration;
        truth.low = truth.high = test::true_distance(polytope_of(pair.a), polytope_of(pair.b), false);
    } else {
        truth.source = Source::search;
        truth.low = bounds.low;
        truth.high = bounds.high;
        return truth;
    }
    // They differ by their rounding.
    const Real rounding = agreement * test::size_of(pair);
    truth.agrees = !bounded || (bounds.low <= truth.high + rounding && bounds.high >= truth.low - rounding);
    return truth;
}

double regret(const TruePair& pair, const Truth& truth, const std::array<double, 3>& normal) {
    const Real3 n{normal[0], normal[1], normal[2]};
    if (!is_plane(pair.a) && !is_plane(pair.b)) return static_cast<double>(truth.low - Difference(pair).apart(n));
    const TrueBody& plane = is_plane(pair.a) ? pair.a : pair.b;
    const auto axes = test::axes(plane);
    const auto flat = test::unit_plane(plane);
    Real off = 0;
    for (unsigned d = 0; d < 3; ++d) {
        const test::Exact up = flat[0] * axes[0][d] + flat[1] * axes[1][d] + flat[2] * axes[2][d];
        const Real x = static_cast<Real>(up) + (is_plane(pair.a) ? -n[d] : n[d]);
        off += x * x;
    }
    return static_cast<double>(std::sqrt(off)) * test::size_of(pair);
}

}  // namespace clinch::accuracy
