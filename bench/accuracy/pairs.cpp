#include "bench/accuracy/pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace clinch::accuracy {
namespace {

using test::Kind;
using test::Random;
using test::TrueBody;
using test::TruePair;

const std::vector<double> distances = {-0.5, -1e-1, -1e-2, -1e-3, -1e-6, -1e-9, 0, 1e-9, 1e-6, 1e-3, 1e-2, 1e-1, 1, 10};
const std::vector<double> ratios = {1, 1e2, 1e5}, aspects = {1, 1e2, 1e4}, offsets = {0, 1e3, 1e6},
                          vertices = {4, 8, 32, 128, 512}, angles = {-1, 0, 1e-9, 1e-6, 1e-4, 1e-2},
                          usual_distances = {-1e-1, -1e-2, -1e-3, 1e-3, 1e-2, 1e-1};

double one_of(const std::vector<double>& values, Random& random) {
    return values[random.below(values.size())];
}

std::array<double, 4> random_rotation(Random& random) {
    for (;;) {
        std::array<double, 4> q{};
        double square = 0;
        for (double& x : q) {
            x = random.between(-1, 1);
            square += x * x;
        }
        if (square < 0.01 || square > 1) continue;
        for (double& x : q) x /= std::sqrt(square);
        return q;
    }
}

Real3 random_direction(Random& random) {
    for (;;) {
        const Real3 v{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
        if (length(v) > 0.1L && length(v) < 1) return unit(v);
    }
}

std::array<double, 4> product(const std::array<double, 4>& a, const std::array<double, 4>& b) {
    return {
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

TrueBody body_of(Kind kind, double size, const Lie& lie, Random& random) {
    TrueBody body;
    body.kind = kind;
    // Of each three sizes one is whole, one as thin as asked, and one between.
    std::array<double, 3> factors{1, 1 / lie.aspect, std::pow(lie.aspect, -random.between(0, 1))};
    for (std::size_t i = 2; i > 0; --i) std::swap(factors[i], factors[random.below(i + 1)]);
    // Of two sizes, one is whole.
    if (kind != Kind::box && kind != Kind::hull && factors[0] != 1 && factors[1] != 1) factors[random.below(2)] = 1;
    for (std::size_t d = 0; d < 3; ++d) body.size[d] = size * factors[d] * random.between(0.35, 0.5);
    if (kind == Kind::plane) {
        body.size[0] = size * random.between(-1, 1);
        const Real3 n = random_direction(random);
        for (std::size_t d = 0; d < 3; ++d) body.normal[d] = static_cast<double>(n[d]);
    }
    if (kind == Kind::hull)
        for (int i = 0; i < lie.vertices; ++i) {  // on an ellipsoid: each is a corner
            const Real3 n = random_direction(random);
            body.points.push_back({body.size[0] * static_cast<double>(n[0]), body.size[1] * static_cast<double>(n[1]),
                                   body.size[2] * static_cast<double>(n[2])});
        }
    body.rotation = random_rotation(random);
    return body;
}

double reach_of(const TrueBody& body) {
    if (body.kind == Kind::sphere) return body.size[0];
    if (body.kind == Kind::capsule) return body.size[0] + body.size[1];
    if (body.kind == Kind::box || body.kind == Kind::hull)
        return std::sqrt(body.size[0] * body.size[0] + body.size[1] * body.size[1] + body.size[2] * body.size[2]);
    return std::hypot(body.size[0], body.size[1]);
}

void set_between(TruePair& pair, const Real3& between) {
    for (std::size_t d = 0; d < 3; ++d) pair.b.position[d] = static_cast<double>(Real(pair.a.position[d]) + between[d]);
}

/// A direction in which features of both bodies may meet: any, a face's, that of two edges, across an axis.
Real3 contact_direction(const Reach& a, const Reach& b, Random& random) {
    const Real sign = random.below(2) == 0 ? 1 : -1;
    const Real3 u = a.axis(random.below(3)), v = b.axis(random.below(3));
    Real3 n = random_direction(random);
    switch (random.below(6)) {
        case 0:
            n = u;
            break;
        case 1:
            n = v;
            break;
        case 2:
            if (length(cross(u, v)) > 1e-3L) n = unit(cross(u, v));
            break;
        case 3:
            n = unit(cross(random.below(2) == 0 ? u : v, n));
            break;
        default:
            break;
    }
    return {sign * n[0], sign * n[1], sign * n[2]};
}

/// Puts b where the two bodies are `aim` apart along some direction; inside of the features that touch there.
void place(TruePair& pair, double aim, Random& random) {
    const Difference touching(pair);
    const Real3 n = contact_direction(touching.a, touching.b, random);
    Real3 at{};
    Real parts = 0;
    for (int i = 0; i < 3; ++i) {
        const Real part = random.between(0.1, 1);
        at = along(at, part, touching.point(along(n, 1e-6L, random_direction(random))));
        parts += part;
    }
    at = {at[0] / parts, at[1] / parts, at[2] / parts};
    set_between(pair, along(at, touching.balls() + aim, n));
    if (!has_volume(pair.a.kind, pair.b.kind)) return;
    // Some other direction may have been nearer, and what is curved has been cut short.
    for (int i = 0; i < 2; ++i) {
        const Difference now(pair);
        const Bounds bounds = bounds_of(now);
        set_between(pair, along(now.between, aim - bounds.low, bounds.normal));
    }
}

/// Puts the body that is not the plane `aim` above the plane.
void place_above(TruePair& pair, double aim, Random& random) {
    const bool first = pair.a.kind == Kind::plane;
    const TrueBody& plane = first ? pair.a : pair.b;
    const double reach = reach_of(first ? pair.b : pair.a);
    const auto axes = test::axes(plane);
    const auto flat = test::unit_plane(plane);
    Real3 up{}, at{};
    for (unsigned d = 0; d < 3; ++d) {
        up[d] = static_cast<Real>(flat[0] * axes[0][d] + flat[1] * axes[1][d] + flat[2] * axes[2][d]);
        if (!first) up[d] = -up[d];
        at[d] = random.between(-2, 2) * reach;
    }
    set_between(pair, at);
    for (int i = 0; i < 2; ++i) {
        const Real distance = static_cast<Real>(test::true_distance(pair.a, pair.b));
        at = along(at, aim - distance, up);
        set_between(pair, at);
    }
}

}  // namespace

std::vector<Setting> settings_of(Kind a, Kind b, bool quick) {
    std::vector<Setting> settings = {{"default", 0}};
    const auto axis = [&](const char* name, const std::vector<double>& values) {
        for (std::size_t i = 0; i < values.size(); ++i)
            if (!quick || i == 0 || i + 1 == values.size()) settings.push_back({name, values[i]});
    };
    axis("distance", distances);
    axis("ratio", ratios);
    const auto plain = [](Kind k) { return k == Kind::sphere || k == Kind::plane; };
    if (!plain(a) || !plain(b)) axis("aspect", aspects);
    axis("offset", offsets);
    if (a == Kind::hull || b == Kind::hull) axis("vertices", vertices);
    if (!plain(a) && !plain(b)) axis("angle", angles);
    settings.push_back({"mixture", 0});
    return settings;
}

Lie lie_of(const Setting& setting, Random& random) {
    Lie lie;
    lie.distance = one_of(usual_distances, random);
    if (setting.axis == "distance") lie.distance = setting.value;
    if (setting.axis == "ratio") lie.ratio = setting.value;
    if (setting.axis == "aspect") lie.aspect = setting.value;
    if (setting.axis == "offset") lie.offset = setting.value;
    if (setting.axis == "vertices") lie.vertices = static_cast<int>(setting.value);
    if (setting.axis == "angle") lie.angle = setting.value;
    if (setting.axis != "mixture") return lie;
    lie.distance = one_of(distances, random);
    lie.ratio = one_of(ratios, random);
    lie.aspect = one_of(aspects, random);
    lie.offset = one_of(offsets, random);
    lie.vertices = static_cast<int>(one_of(vertices, random));
    lie.angle = one_of(angles, random);
    return lie;
}

Sample sample_of(Kind a, Kind b, const Lie& lie, Random& random) {
    Sample sample;
    TruePair& pair = sample.pair;
    const bool large_first = random.below(2) == 0;
    pair.a = body_of(a, large_first ? lie.ratio : 1, lie, random);
    pair.b = body_of(b, large_first ? 1 : lie.ratio, lie, random);
    if (lie.angle >= 0) {
        const Real3 axis = random_direction(random);
        std::array<double, 4> tilt{std::cos(lie.angle / 2)};
        for (std::size_t d = 0; d < 3; ++d) tilt[1 + d] = std::sin(lie.angle / 2) * static_cast<double>(axis[d]);
        pair.b.rotation = product(pair.a.rotation, tilt);
    }
    const bool plane_first = a == Kind::plane, plane_last = b == Kind::plane;
    const double reach_a = reach_of(pair.a), reach_b = reach_of(pair.b);
    sample.unit = plane_first ? reach_b : plane_last ? reach_a : std::min(reach_a, reach_b);
    const Real3 away = random_direction(random);
    for (std::size_t d = 0; d < 3; ++d)
        pair.a.position[d] = lie.offset * std::max(reach_a, reach_b) * static_cast<double>(away[d]);
    if (plane_first || plane_last)
        place_above(pair, lie.distance * sample.unit, random);
    else
        place(pair, lie.distance * sample.unit, random);
    sample.size = test::size_of(pair);
    sample.truth = truth_of(pair, lie.angle >= 0 && lie.angle < 1e-3);
    return sample;
}

}  // namespace clinch::accuracy
