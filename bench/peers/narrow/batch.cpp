#include "bench/peers/narrow/batch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "bench/peers/narrow/hull_faces.hpp"
#include "bench/scenes/random.hpp"
#include "clinch/narrow_phase.hpp"
#include "tests/narrow_phase/polytope_oracle.hpp"

namespace clinch::peers::narrow {
namespace {

using scenes::Random;

constexpr std::size_t plane_kind = 5, hull_kind = 6;
constexpr const char* kind_names[] = {"sphere", "box", "capsule", "cylinder", "cone", "plane"};

ShapeKind kind_of(const std::string& text) {
    for (std::size_t kind = 0; kind < hull_kind; ++kind)
        if (text == kind_names[kind]) return {kind, 0};
    const std::string digits = text.rfind("hull:", 0) == 0 ? text.substr(5) : "";
    if (!digits.empty() && digits.size() < 5 && digits.find_first_not_of("0123456789") == std::string::npos) {
        const std::size_t vertices = std::stoul(digits);
        if (vertices >= 4 && vertices <= 1024) return {hull_kind, vertices};
    }
    throw std::invalid_argument(
        "'" + text + "' is not one of sphere, box, capsule, cylinder, cone, plane, hull:VERTICES (4 to 1024)");
}

double length(const Vec3& v) {
    return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

double dot(const Vec3& a, const Vec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

Vec3 along(const Vec3& p, double by, const Vec3& n) {
    return {p.x + by * n.x, p.y + by * n.y, p.z + by * n.z};
}

Vec3 direction(Random& random) {
    const std::array<double, 3> v = random.direction();
    return {v[0], v[1], v[2]};
}

Quat rotation(Random& random) {
    const std::array<double, 4> q = random.unit_vector<4>();
    return {q[0], q[1], q[2], q[3]};
}

// Corners all over an ellipsoid, so that each stands out and the hull is about as thick as it is wide: points of a
// spiral at even heights, each pushed aside at random.
PoolShape random_hull(std::size_t vertices, Random& random) {
    Hull hull;
    const Vec3 half{random.between(0.3, 0.5), random.between(0.3, 0.5), random.between(0.3, 0.5)};
    const auto n = static_cast<double>(vertices);
    for (std::size_t i = 0; i < vertices; ++i) {
        const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / n, across = std::sqrt(1.0 - z * z);
        const double angle = 2.399963229728653 * static_cast<double>(i),
                     aside = random.between(0.0, 1.0 / std::sqrt(n));
        const Vec3 p = along({across * std::cos(angle), across * std::sin(angle), z}, aside, direction(random));
        const double scale = 1.0 / length(p);
        hull.points.push_back({half.x * scale * p.x, half.y * scale * p.y, half.z * scale * p.z});
    }
    PoolShape out;
    out.faces = hull_faces(hull.points);
    out.shape = std::move(hull);
    return out;
}

PoolShape random_shape(const ShapeKind& kind, Random& random) {
    const auto radius = [&] { return random.between(0.15, 0.35); };
    const auto half = [&] { return random.between(0.2, 0.5); };
    switch (kind.kind) {
        case 0:
            return {Sphere{random.between(0.3, 0.5)}, {}};
        case 1:
            return {Box{{half(), half(), half()}}, {}};
        case 2:
            return {Capsule{radius(), half()}, {}};
        case 3:
            return {Cylinder{radius(), half()}, {}};
        case 4:
            return {Cone{radius(), half()}, {}};
        case plane_kind:
            return {Plane{direction(random), random.between(-0.5, 0.5)}, {}};
        default:
            return random_hull(kind.vertices, random);
    }
}

struct Reach {
    double operator()(const Sphere& s) const { return s.radius; }
    double operator()(const Box& s) const { return length(s.half_extents); }
    double operator()(const Capsule& s) const { return s.radius + s.half_height; }
    double operator()(const Cylinder& s) const { return std::hypot(s.radius, s.half_height); }
    double operator()(const Cone& s) const { return std::hypot(s.radius, s.half_height); }
    double operator()(const Plane&) const { return 0.0; }
    double operator()(const Hull& s) const {
        double most = 0.0;
        for (const Vec3& p : s.points) most = std::max(most, length(p));
        return most;
    }
    double operator()(const Mesh&) const { return 0.0; }
};

/// Highest point along n, which is seen from the body.
struct Highest {
    Vec3 n;
    double across() const { return std::sqrt(n.x * n.x + n.y * n.y); }
    double operator()(const Sphere& s) const { return s.radius * length(n); }
    double operator()(const Box& s) const {
        return std::fabs(n.x) * s.half_extents.x + std::fabs(n.y) * s.half_extents.y +
               std::fabs(n.z) * s.half_extents.z;
    }
    double operator()(const Capsule& s) const { return s.radius * length(n) + std::fabs(n.z) * s.half_height; }
    double operator()(const Cylinder& s) const { return s.radius * across() + std::fabs(n.z) * s.half_height; }
    double operator()(const Cone& s) const {
        return std::max(n.z * s.half_height, s.radius * across() - n.z * s.half_height);
    }
    double operator()(const Plane& s) const {
        const Vec3 away = along(n, -dot(n, s.normal), s.normal);
        const bool upright = dot(n, s.normal) > 0.0 && length(away) < 0.03;
        return upright ? s.offset * dot(n, s.normal) : std::numeric_limits<double>::infinity();
    }
    double operator()(const Hull& s) const {
        double most = -std::numeric_limits<double>::infinity();
        for (const Vec3& p : s.points) most = std::max(most, dot(n, p));
        return most;
    }
    double operator()(const Mesh&) const { return std::numeric_limits<double>::quiet_NaN(); }
};

void find_truth(Batch& batch) {
    // Wide enough for every pair to have a row.
    const Scene scene = scene_of(batch, 100.0);
    std::vector<Pair> pairs;
    for (std::uint32_t i = 0; i < batch.pairs(); ++i) pairs.push_back({2 * i, 2 * i + 1});
    Context host = Context::host_only();
    NarrowPhaseOptions options;
    options.precision = 1.0;
    NarrowPhase narrow_phase(host, options);
    batch.truth.assign(batch.pairs(), {std::numeric_limits<double>::quiet_NaN(), 0.0, {}});
    for (const Contact& c : narrow_phase.find(scene, pairs)) {
        Truth& truth = batch.truth[c.a / 2];
        if (!(truth.distance <= c.distance)) truth = {c.distance, c.error, c.normal};
    }
    for (const Truth& truth : batch.truth)
        if (std::isnan(truth.distance)) throw std::runtime_error("a pair of the batch has no distance");
}

// Moving b along the normal of two bodies apart changes their distance by just as much, until they overlap.
void move_to_regime(Batch& batch, Random& random) {
    for (std::size_t i = 0; i < batch.pairs(); ++i) {
        const double wanted = random.between(0.01, 0.1) * batch.size[i];
        const Truth& now = batch.truth[i];
        Vec3& position = batch.pose[2 * i + 1].position;
        position = along(position, (batch.regime == Regime::Gap ? wanted : -wanted) - now.distance, now.normal);
    }
}

test::Polytope polytope_of(const Shape& shape, const Pose& pose) {
    test::Polytope out;
    out.rotation = pose.rotation;
    out.position = pose.position;
    if (const auto* const sphere = std::get_if<Sphere>(&shape)) {
        out.points = {Vec3{}};
        out.ball = sphere->radius;
    } else if (const auto* const box = std::get_if<Box>(&shape)) {
        const Vec3& e = box->half_extents;
        for (const double x : {-e.x, e.x})
            for (const double y : {-e.y, e.y})
                for (const double z : {-e.z, e.z}) out.points.push_back({x, y, z});
    } else if (const auto* const capsule = std::get_if<Capsule>(&shape)) {
        out.points = {{0.0, 0.0, -capsule->half_height}, {0.0, 0.0, capsule->half_height}};
        out.ball = capsule->radius;
    } else {
        out.points = std::get<Hull>(shape).points;
    }
    return out;
}

bool is_polytope(const ShapeKind& kind) {
    return kind.kind <= 2 || kind.kind == hull_kind;
}

}  // namespace

Cell cell_of(const std::string& text) {
    const std::size_t dash = text.find('-');
    if (dash == std::string::npos) throw std::invalid_argument("'" + text + "' is not of the form SHAPE-SHAPE");
    Cell cell{text, kind_of(text.substr(0, dash)), kind_of(text.substr(dash + 1))};
    if (cell.a.kind == plane_kind) throw std::invalid_argument("'" + text + "': a plane stands second");
    return cell;
}

Batch make_batch(const Cell& cell, Regime regime, std::size_t pairs, std::size_t shapes, std::uint64_t seed) {
    Random random(seed);
    Batch batch;
    batch.cell = cell;
    batch.regime = regime;
    for (std::size_t i = 0; i < 2 * shapes; ++i)
        batch.shapes.push_back(random_shape(i < shapes ? cell.a : cell.b, random));
    std::vector<double> reach;
    for (const PoolShape& shape : batch.shapes) reach.push_back(std::visit(Reach{}, shape.shape));
    const auto count = static_cast<std::uint64_t>(shapes);
    for (std::size_t i = 0; i < pairs; ++i) {
        const auto a = static_cast<std::uint32_t>(random.below(count));
        const auto b = static_cast<std::uint32_t>(count + random.below(count));
        batch.shape.insert(batch.shape.end(), {a, b});
        const bool plane = reach[a] == 0.0 || reach[b] == 0.0;
        batch.size.push_back((plane ? 2.0 : 1.0) * (reach[a] + reach[b]));
        const Vec3 at{random.between(-5.0, 5.0), random.between(-5.0, 5.0), random.between(-5.0, 5.0)};
        batch.pose.push_back({at, rotation(random)});
        batch.pose.push_back({along(at, 1.1 * batch.size.back(), direction(random)), rotation(random)});
    }
    for (const double size : batch.size) batch.largest_size = std::max(batch.largest_size, size);
    find_truth(batch);
    move_to_regime(batch, random);
    find_truth(batch);
    return batch;
}

Scene scene_of(const Batch& batch, double margin) {
    Scene scene;
    std::vector<ShapeId> ids;
    for (const PoolShape& shape : batch.shapes) ids.push_back(scene.add_shape(shape.shape));
    for (std::size_t i = 0; i < batch.pose.size(); ++i) {
        Body body;
        body.shape = ids[batch.shape[i]];
        body.pose = batch.pose[i];
        body.margin = margin;
        scene.add_body(body);
    }
    return scene;
}

std::array<double, 9> matrix_of(const Quat& q) {
    const double w = q.w, x = q.x, y = q.y, z = q.z;
    return {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z),       2.0 * (x * z + w * y),
            2.0 * (x * y + w * z),       1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x),
            2.0 * (x * z - w * y),       2.0 * (y * z + w * x),       1.0 - 2.0 * (x * x + y * y)};
}

double highest(const Batch& batch, std::size_t body, const Vec3& n) {
    const Pose& pose = batch.pose[body];
    const std::array<double, 9> m = matrix_of(pose.rotation);
    const Vec3 own{m[0] * n.x + m[3] * n.y + m[6] * n.z, m[1] * n.x + m[4] * n.y + m[7] * n.z,
                   m[2] * n.x + m[5] * n.y + m[8] * n.z};
    return dot(n, pose.position) + std::visit(Highest{own}, batch.shapes[batch.shape[body]].shape);
}

OracleCheck check_truth(const Batch& batch, std::size_t pairs) {
    OracleCheck check;
    if (!is_polytope(batch.cell.a) || !is_polytope(batch.cell.b) || batch.pairs() == 0) return check;
    const std::size_t many = std::max<std::size_t>(1, batch.cell.a.vertices * batch.cell.b.vertices / 1024);
    check.pairs = std::min(batch.pairs(), std::max<std::size_t>(1, pairs / many));
    for (std::size_t k = 0; k < check.pairs; ++k) {
        const std::size_t i = k * batch.pairs() / check.pairs, a = 2 * i, b = a + 1;
        const long double true_distance =
            test::true_distance(polytope_of(batch.shapes[batch.shape[a]].shape, batch.pose[a]),
                                polytope_of(batch.shapes[batch.shape[b]].shape, batch.pose[b]), false);
        const auto off =
            static_cast<double>(std::fabs(true_distance - static_cast<long double>(batch.truth[i].distance)));
        check.worst = std::max(check.worst, off / batch.size[i]);
    }
    return check;
}

}  // namespace clinch::peers::narrow
