#include "tests/narrow_phase/campaign_cases.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/narrow_phase/campaign_threads.hpp"

namespace clinch::test::campaign {
namespace {

constexpr std::size_t block = 256;  // pairs that share a sequence of random numbers

double power(double low, double high, Random& random) {
    return std::pow(10.0, random.between(low, high));
}

double sign(Random& random) {
    return random.below(2) == 0 ? 1.0 : -1.0;
}

Real3 direction(Random& random) {
    for (;;) {
        const Real3 v{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
        const Real square = v.dot(v);
        if (square > 0.01L && square < 1) return unit(v);
    }
}

Quat rotation(Random& random) {
    for (;;) {
        const Quat q{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
        const double square = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
        if (square < 0.1 || square > 1) continue;
        const double per = 1 / std::sqrt(square);
        return {q.w * per, q.x * per, q.y * per, q.z * per};
    }
}

Quat about(const Real3& axis, double angle) {
    const double s = std::sin(angle / 2);
    return {std::cos(angle / 2), s * static_cast<double>(axis.x), s * static_cast<double>(axis.y),
            s * static_cast<double>(axis.z)};
}

Quat product(const Quat& a, const Quat& b) {
    const Quat q{a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                 a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
    const double per = 1 / std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return {q.w * per, q.x * per, q.y * per, q.z * per};
}

Real3 coordinate_axis(std::size_t d) {
    return {d == 0 ? 1.0L : 0, d == 1 ? 1.0L : 0, d == 2 ? 1.0L : 0};
}

Quat square_turn(Random& random) {
    return about(coordinate_axis(random.below(3)), static_cast<double>(random.below(4)) * 1.5707963267948966);
}

double size_near(double scale, Random& random) {
    switch (random.below(4)) {
        case 0:
            return scale;
        case 1:
            return scale * (1.0 + static_cast<double>(random.below(3)));
        case 2:
            return scale * power(-0.5, 0.5, random);
        default:
            return scale * power(-4, 0, random);
    }
}

Hull random_hull(double scale, Random& random) {
    const std::size_t count = random.below(16) == 0 ? 12 + random.below(13) : 4 + random.below(7);
    const double e[3] = {size_near(scale, random), size_near(scale, random), size_near(scale, random)};
    const double off = random.below(3) == 0 ? scale : 0;
    const Vec3 at{off * random.between(-1, 1), off * random.between(-1, 1), off * random.between(-1, 1)};
    const std::uint64_t style = random.below(4);
    Hull hull;
    for (std::size_t i = 0; i < count; ++i) {
        std::array<double, 3> v{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
        if (style == 1) {
            const Real3 d = direction(random);
            v = {static_cast<double>(d.x), static_cast<double>(d.y), static_cast<double>(d.z)};
        }
        if (style == 2) {  // a prism: two parallel faces of many points
            const double angle =
                6.283185307179586 * std::floor(static_cast<double>(i) / 2) / std::ceil(static_cast<double>(count) / 2);
            v = {std::cos(angle), std::sin(angle), i % 2 == 0 ? 1.0 : -1.0};
        }
        if (style == 3) v = {std::copysign(1.0, v[0]), std::copysign(1.0, v[1]), v[2] < 0.5 ? -1.0 : 1.0};
        hull.points.push_back({at.x + e[0] * v[0], at.y + e[1] * v[1], at.z + e[2] * v[2]});
    }
    if (random.below(4) == 0) hull.points.push_back(hull.points.front());  // repeated
    if (random.below(4) == 0) {                                            // in an edge or a face
        const Vec3 p = hull.points[0], q = hull.points[1];
        hull.points.push_back({(p.x + q.x) / 2, (p.y + q.y) / 2, (p.z + q.z) / 2});
    }
    return hull;
}

Shape any_shape(std::size_t kind, double scale, Random& random) {
    const auto size = [&] { return size_near(scale, random); };
    switch (kind) {
        case sphere:
            return Sphere{size()};
        case box: {
            if (random.below(6) == 0) return Box{{scale, scale, scale}};
            return Box{{size(), size(), size()}};
        }
        case capsule: {
            const double radius = size();
            return Capsule{radius, random.below(8) == 0 ? 0.0 : size()};
        }
        case cylinder: {
            const double radius = size();
            return Cylinder{radius, size()};
        }
        case cone: {
            const double radius = size();
            return Cone{radius, size()};
        }
        case plane: {
            Plane plane;
            if (random.below(2) == 0) {
                const Real3 n = direction(random) * (1 + 9e-4L * random.between(-1, 1));
                plane.normal = {static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)};
            }
            plane.offset = random.below(2) == 0 ? 0 : random.between(-1, 1) * scale;
            return plane;
        }
        default:
            return random_hull(scale, random);
    }
}

Shape valid_shape(std::size_t kind, double scale, Random& random) {
    for (int i = 0; i < 64; ++i) {
        Shape shape = any_shape(kind, scale * (random.below(2) == 0 ? 1.0 : power(-5, 0, random)), random);
        if (why_invalid(shape).empty()) return shape;
    }
    return any_shape(kind == hull ? box : kind, scale, random);
}

double batch_scale(Random& random) {
    const double scales[] = {1e-310, 1e-42, 1e-38, 1e-30, 1e-12, 1e-3, 1e12, 1e20};
    return random.below(2) == 0 ? scales[random.below(8)] : 1.0;
}

// One pair, laid out step by step.
struct Layout {
    CampaignPair& pair;
    Random& random;
    double size;  // of both bodies together

    Posed<Real> turned(const CampaignBody& body) const { return posed(body, body).a; }
    void turn() const {
        CampaignBody &a = pair.a, &b = pair.b;
        for (CampaignBody* body : {&a, &b}) {
            const std::uint64_t way = random.below(4);
            body->rotation = way == 0 ? Quat{} : way == 1 ? square_turn(random) : rotation(random);
        }
        if (random.below(3) == 0) return;
        Quat tilt;
        if (random.below(3) != 0) {
            const Real3 axis = random.below(2) == 0 ? coordinate_axis(random.below(3)) : direction(random);
            tilt = about(axis, power(-9, -2, random) * sign(random));
        }
        b.rotation = product(a.rotation, random.below(2) == 0 ? product(square_turn(random), tilt) : tilt);
        if (random.below(4) == 0) b.rotation = a.rotation;
    }
    // From -10 to 10 sizes, with 0 and what is near it.
    double distance() const {
        const bool of_smaller = random.below(2) == 0;
        const double unit_of_it = of_smaller ? std::min(pair.a.form->reach, pair.b.form->reach) : size;
        switch (random.below(6)) {
            case 0:
                return 0;
            case 1:
                return unit_of_it * power(-3, 1, random);
            case 2:
                return -unit_of_it * random.between(0, 1);
            case 3:
                return unit_of_it * power(-12, -3, random);
            default:
                return unit_of_it * power(-10, -2, random) * sign(random);
        }
    }
    Real3 normal_of(const CampaignBody& body) const {
        const Posed<Real> placed = turned(body);
        const std::vector<Real3>& normals = body.form->normals;
        if (!normals.empty() && random.below(2) == 0) return placed.turned(normals[random.below(normals.size())]);
        return placed.axis(random.below(3)) * static_cast<Real>(sign(random));
    }
    // Along n, from support to support, and perhaps to one side.
    void lay_along(const Real3& n, double distance) const {
        pair.hint = n;
        const Posed<Real> a = turned(pair.a), b = turned(pair.b);
        const Real balls = Real(pair.a.form->ball) + pair.b.form->ball;
        Real3 at = farthest(a, n) - farthest(b, -n) + n * (balls + distance);
        if (random.below(2) == 0) {
            const Real3 aside = direction(random);
            at = at + (aside - n * n.dot(aside)) * (2 * random.between(-1, 1) * pair.a.form->reach);
        }
        put(at);
    }
    void put(const Real3& at) const {
        pair.b.position = {static_cast<double>(at.x), static_cast<double>(at.y), static_cast<double>(at.z)};
    }
    void lay() const {
        switch (random.below(8)) {
            case 0: {  // about one centre
                if (random.below(2) == 0) pair.b.position = {};
                if (random.below(2) == 0) put(direction(random) * static_cast<Real>(size * power(-12, -1, random)));
                return;
            }
            case 1: {  // on an axis
                const Real3 axis = turned(random.below(2) == 0 ? pair.a : pair.b).axis(random.below(3));
                put(axis *
                    static_cast<Real>(size * (random.below(2) == 0 ? random.between(-1, 1) : distance() / size)));
                return;
            }
            case 2:
                put(direction(random) * static_cast<Real>(size * random.between(0, 1.5)));
                return;
            case 3:
                return lay_along(direction(random), distance());
            case 4:
            case 5:
                return lay_along(normal_of(pair.a), distance());
            case 6:
                return lay_along(-normal_of(pair.b), distance());
            default:
                return lay_along(unit(normal_of(pair.a).cross(normal_of(pair.b))), distance());
        }
    }
    // The body against the half-space, to 1e4 sizes along it.
    void lay_on_plane(bool plane_first) const {
        CampaignBody& half_space = plane_first ? pair.a : pair.b;
        CampaignBody& body = plane_first ? pair.b : pair.a;
        const Form& form = *half_space.form;
        const Posed<Real> placed = turned(half_space);
        const Real3 up = placed.turned(form.normals[0]), low = farthest(turned(body), -up);
        const Real3 aside = direction(random);
        const double most = random.below(2) == 0 ? 1.0 : power(0, 4, random);
        const Real3 foot =
            up * form.heights[0] + (aside - up * up.dot(aside)) * static_cast<Real>(most * body.form->reach);
        pair.hint = plane_first ? up : -up;
        const Real3 way = foot + up * (distance() + Real(body.form->ball)) - low;
        // From the first body to the second.
        put(plane_first ? way : -way);
    }
    void move_away() const {
        if (random.below(2) == 0) return;
        const Real3 far = direction(random) * static_cast<Real>(size * (random.below(2) == 0 ? 1e3 : 1e6));
        for (Vec3* p : {&pair.a.position, &pair.b.position})
            *p = {p->x + static_cast<double>(far.x), p->y + static_cast<double>(far.y),
                  p->z + static_cast<double>(far.z)};
    }
};

void lay_out(CampaignPair& pair, Random& random) {
    const Layout layout{pair, random, pair.a.form->reach + pair.b.form->reach};
    layout.turn();
    if (pair.a.form->kind == pair.b.form->kind && random.below(64) == 0) {
        pair.b = pair.a;  // the same body twice
        pair.hint = {0, 0, 1};
    } else if (pair.a.form->kind == plane || pair.b.form->kind == plane) {
        layout.lay_on_plane(pair.a.form->kind == plane);
    } else {
        pair.hint = {0, 0, 1};
        layout.lay();
    }
    layout.move_away();
}

CampaignPair moved(const CampaignPair& pair, Random& random) {
    CampaignPair out = pair;
    const Quat turn = rotation(random);
    const Posed<Real> frame = posed({pair.a.form, turn, {}}, pair.b).a;
    const Vec3 &p = pair.a.position, &q = pair.b.position;
    const Real3 way = frame.turned({Real(q.x) - p.x, Real(q.y) - p.y, Real(q.z) - p.z});
    const double size = pair.a.form->reach + pair.b.form->reach;
    const Real3 a = direction(random) * static_cast<Real>(size * power(0, 6, random)), b = a + way;
    out.a.position = {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
    out.b.position = {static_cast<double>(b.x), static_cast<double>(b.y), static_cast<double>(b.z)};
    out.a.rotation = product(turn, pair.a.rotation);
    out.b.rotation = product(turn, pair.b.rotation);
    out.hint = frame.turned(pair.hint);
    out.kin = Kin::moved;
    return out;
}

void lay_out_block(Batch& batch, std::size_t forms_a, std::size_t begin, std::size_t end, Random& random) {
    const std::size_t forms_b = batch.forms.size() - forms_a;
    for (std::size_t i = begin; i < end; ++i) {
        CampaignPair& pair = batch.pairs[i];
        if (i > begin && random.below(8) == 0) {
            const CampaignPair& before = batch.pairs[i - 1];
            if (random.below(2) == 0)
                pair = moved(before, random);
            else
                pair = {before.b, before.a, -before.hint, Kin::mirrored};
            continue;
        }
        pair.a.form = &batch.forms[random.below(forms_a)];
        pair.b.form = &batch.forms[forms_a + random.below(forms_b)];
        if (random.below(2) == 0) std::swap(pair.a.form, pair.b.form);
        lay_out(pair, random);
    }
}

}  // namespace

Batch batch_of(std::size_t a, std::size_t b, std::size_t count, std::uint64_t seed, std::uint64_t number) {
    Random random(seed + 1000003 * number);
    const double scale = number % 4 == 3 ? batch_scale(random) : 1.0;
    const std::size_t forms_each = std::clamp<std::size_t>(count / 16, 8, 64);
    Batch batch;
    for (const std::size_t kind : {a, b})
        for (std::size_t i = 0; i < forms_each; ++i) batch.forms.push_back(form_of(valid_shape(kind, scale, random)));
    batch.pairs.resize(count);
    in_threads((count + block - 1) / block, [&](std::size_t i) {
        Random own(seed + 1000003 * number + 7919 * (i + 1));
        lay_out_block(batch, forms_each, i * block, std::min(count, (i + 1) * block), own);
    });
    return batch;
}

Scene scene_of(const Batch& batch, double margin) {
    Scene scene;
    for (const Form& form : batch.forms) scene.add_shape(form.shape);
    std::vector<double> positions, rotations;
    std::vector<std::uint32_t> shapes;
    for (const CampaignPair& pair : batch.pairs)
        for (const CampaignBody* body : {&pair.a, &pair.b}) {
            positions.insert(positions.end(), {body->position.x, body->position.y, body->position.z});
            rotations.insert(rotations.end(), {body->rotation.w, body->rotation.x, body->rotation.y, body->rotation.z});
            shapes.push_back(static_cast<std::uint32_t>(body->form - batch.forms.data()));
        }
    const std::size_t rows = shapes.size();
    Body body;
    body.margin = margin;
    scene.add_bodies(rows, body);
    scene.set_shapes(shapes.data(), rows);
    scene.set_positions(positions.data(), rows);
    scene.set_rotations(rotations.data(), rows);
    return scene;
}

}  // namespace clinch::test::campaign
