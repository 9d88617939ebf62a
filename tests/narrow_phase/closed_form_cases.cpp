#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>

#include "tests/narrow_phase/closed_form_cases.hpp"

namespace clinch::test {
namespace {

double log_between(double low, double high, Random& random) {
    return std::exp(random.between(std::log(low), std::log(high)));
}

std::array<double, 4> any_rotation(Random& random) {
    std::array<double, 4> q{};
    double square = 0;
    do {
        square = 0;
        for (double& x : q) {
            x = random.between(-1, 1);
            square += x * x;
        }
    } while (square > 1 || square < 1e-3);
    return q;
}

std::array<double, 4> product(const std::array<double, 4>& a, const std::array<double, 4>& b) {
    return {
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

TrueBody random_body(Kind kind, double scale, Random& random) {
    TrueBody body;
    body.kind = kind;
    for (double& s : body.size) {
        const double factors[] = {1, 1.0 + static_cast<double>(random.below(3)), log_between(0.3, 3, random),
                                  log_between(1e-4, 1, random)};
        s = scale * factors[random.below(4)];
    }
    if (kind == Kind::capsule && random.below(8) == 0) body.size[1] = 0;
    if (kind == Kind::plane) {
        body.size[0] = random.below(3) == 0 ? 0 : random.between(-1, 1) * scale;
        if (random.below(3) != 0)
            for (double& x : body.normal) x = random.between(-1, 1);
    }
    if (kind == Kind::hull)
        for (std::uint64_t n = 4 + random.below(40); n > 0; --n)
            body.points.push_back(
                {random.between(-1, 1) * scale, random.between(-1, 1) * scale, random.between(-1, 1) * scale});
    if (random.below(4) == 0) body.rotation[1 + random.below(3)] = 1;  // a quarter turn
    if (random.below(2) == 0) body.rotation = any_rotation(random);
    return body;
}

/// Turns b like a, but for a small angle, or none.
void make_parallel(TruePair& pair, Random& random) {
    std::array<double, 4> tilt{1, 0, 0, 0};
    if (random.below(4) != 0) {
        const auto q = any_rotation(random);
        const double angle = log_between(1e-9, 1e-2, random);
        for (std::size_t i = 1; i < 4; ++i) tilt[i] = q[i] * angle;
    }
    if (random.below(3) == 0) tilt = product(tilt, {1, 0, 0, random.between(-1, 1)});
    if (random.below(3) == 0) tilt[1 + random.below(3)] += 1;
    pair.b.rotation = product(pair.a.rotation, tilt);
}

double reach_of(const TrueBody& body) {
    switch (body.kind) {
        case Kind::sphere:
            return body.size[0];
        case Kind::box:
            return *std::max_element(body.size.begin(), body.size.end());
        case Kind::plane:
            return 0;
        case Kind::hull: {
            double most = 0;
            for (const auto& p : body.points)
                for (const double x : p) most = std::max(most, std::fabs(x));
            return most;
        }
        default:
            return std::max(body.size[0], body.size[1]);
    }
}

std::array<double, 3> between_of(const TruePair& pair) {
    return {pair.b.position[0] - pair.a.position[0], pair.b.position[1] - pair.a.position[1],
            pair.b.position[2] - pair.a.position[2]};
}

double length_of(const std::array<double, 3>& v, double unit) {
    return unit * std::hypot(v[0] / unit, v[1] / unit, v[2] / unit);
}

void place(TruePair& pair, double reach, Random& random) {
    const auto axis = axes(pair.a);
    const auto any = [&](double most) { return random.between(-1, 1) * most; };
    std::array<double, 3> at{any(1.5 * reach), any(1.5 * reach), any(1.5 * reach)};  // in a's frame
    switch (random.below(7)) {
        case 0:
            at = {};
            break;
        case 1:
            at[0] = at[1] = 0;
            break;
        case 2:
            at[random.below(3)] = at[random.below(3)] = 0;
            break;
        case 3:
            at[0] *= 1e-6, at[1] *= 1e-6;
            break;
        case 4:
            at = {any(2 * pair.a.size[0]), any(2 * pair.a.size[1]), any(2 * pair.a.size[2])};
            break;
        default:
            break;
    }
    for (std::size_t d = 0; d < 3; ++d)
        pair.b.position[d] = static_cast<double>(axis[0][d] * at[0] + axis[1][d] * at[1] + axis[2][d] * at[2]);
}

/// Moves b to and fro until they all but touch, or miss by a small gap or depth.
void bring_to_touch(TruePair& pair, double reach, Random& random) {
    const double aim =
        random.below(4) == 0 ? 0 : reach * log_between(1e-12, 1e-1, random) * (random.below(2) == 0 ? -1 : 1);
    for (int i = 0; i < 4; ++i) {
        const double apart = length_of(pair.b.position, reach);
        const double factor = 1 + (aim - static_cast<double>(true_distance(pair.a, pair.b))) / apart;
        if (!(factor > 0.01 && factor < 100)) return;
        for (double& x : pair.b.position) x *= factor;
    }
}

}  // namespace

const std::vector<std::array<Kind, 2>>& closed_form_pairs() {
    static const std::vector<std::array<Kind, 2>> pairs = {
        {Kind::sphere, Kind::sphere},   {Kind::sphere, Kind::box},     {Kind::sphere, Kind::capsule},
        {Kind::sphere, Kind::cylinder}, {Kind::sphere, Kind::cone},    {Kind::sphere, Kind::plane},
        {Kind::box, Kind::box},         {Kind::box, Kind::plane},      {Kind::capsule, Kind::capsule},
        {Kind::capsule, Kind::plane},   {Kind::cylinder, Kind::plane}, {Kind::cone, Kind::plane},
        {Kind::plane, Kind::hull}};
    return pairs;
}

TruePair random_pair(Kind a, Kind b, Random& random) {
    const double scales[] = {1e-29, 1e15};
    const double scale = random.below(8) == 0 ? scales[random.below(2)] : 1;
    const double ratio = random.below(3) == 0 ? log_between(1e-5, 1, random) : 1;
    const bool small_a = random.below(2) == 0;
    TruePair pair;
    pair.a = random_body(a, scale * (small_a ? ratio : 1), random);
    pair.b = random_body(b, scale * (small_a ? 1 : ratio), random);
    if (random.below(3) == 0) make_parallel(pair, random);
    const double reach = reach_of(pair.a) + reach_of(pair.b);
    place(pair, reach, random);
    if (random.below(3) != 0 && length_of(pair.b.position, reach) > 1e-3 * reach) bring_to_touch(pair, reach, random);
    if (random.below(4) == 0)
        for (std::size_t d = 0; d < 3; ++d) {
            pair.a.position[d] = random.between(-1, 1) * 1e3 * reach;
            pair.b.position[d] += pair.a.position[d];
        }
    return pair;
}

double size_of(const TruePair& pair) {
    double size = reach_of(pair.a) + reach_of(pair.b);
    size += length_of(between_of(pair), size);
    for (const TrueBody* body : {&pair.a, &pair.b})
        if (body->kind == Kind::plane) size += std::fabs(static_cast<double>(unit_plane(*body)[3]));
    return size;
}

std::string broken_promise(const TruePair& pair, const Answer& answer, double unit) {
    const Exact truth = true_distance(pair.a, pair.b);
    const double off = static_cast<double>(abs(Exact(answer.distance) - truth)), size = size_of(pair);
    const double away = length_of(pair.a.position, size);  // what positions lose far from the origin, as floats
    const double lost = unit > 1e-10 ? 0x1p-44 * away : unit * away;
    Exact3 n{}, on_a{}, on_b{};
    double square = 0;
    for (std::size_t d = 0; d < 3; ++d) {
        n[d] = answer.normal[d];
        square += answer.normal[d] * answer.normal[d];
        on_a[d] = answer.point[d];
        on_b[d] = on_a[d] + answer.distance * n[d] - (Exact(pair.b.position[d]) - pair.a.position[d]);
    }
    std::ostringstream why;
    why.precision(17);
    if (!std::isfinite(answer.distance) || !std::isfinite(answer.error)) return "not a number";
    if (!(off <= answer.error)) why << "distance off by " << off << ", promised " << answer.error << "; ";
    if (!(off <= (unit > 1e-10 ? 4e-7 : 1e-14) * size + lost))
        why << "distance off by " << off << " of size " << size << "; ";
    const bool boxes = pair.a.kind == Kind::box && pair.b.kind == Kind::box;
    if (!(answer.error <= (boxes ? 160 : 60) * unit * size + 2 * lost + 1e-36))
        why << "promises no more than " << answer.error << " of size " << size << "; ";
    if (!(std::fabs(std::sqrt(square) - 1) <= 16 * unit)) why << "normal as long as " << std::sqrt(square) << "; ";
    if (pair.a.kind != Kind::plane && pair.b.kind != Kind::plane) {
        const double regret = static_cast<double>(truth - parted_along(pair.a, pair.b, n));
        if (!(regret <= 2 * answer.error)) why << "normal parts them less by " << regret << "; ";
    }
    for (const bool first : {true, false}) {
        const TrueBody& body = first ? pair.a : pair.b;
        if (body.kind == Kind::hull) continue;
        const double outside = static_cast<double>(abs(from_surface(body, first ? on_a : on_b)));
        if (!(outside <= 2 * answer.error))
            why << "point off the " << (first ? "first" : "second") << " by " << outside << "; ";
    }
    return why.str();
}

std::string text_of(const TruePair& pair) {
    std::ostringstream text;
    text.precision(17);
    for (const TrueBody* body : {&pair.a, &pair.b}) {
        text << "\nkind " << static_cast<int>(body->kind) << " size";
        for (const double x : body->size) text << ' ' << x;
        text << " normal";
        for (const double x : body->normal) text << ' ' << x;
        text << " rotation";
        for (const double x : body->rotation) text << ' ' << x;
        text << " position";
        for (const double x : body->position) text << ' ' << x;
        text << " points " << body->points.size();
    }
    return text.str();
}

}  // namespace clinch::test
