// Steps with contacts, against plain formulas for balls and boxes that lie alike.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <map>
#include <utility>
#include <vector>

#include "clinch/error.hpp"
#include "clinch/pipeline.hpp"
#include "tests/device/devices.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

using Real = long double;

struct V {
    Real x, y, z;
};
V operator+(const V& a, const V& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
V operator-(const V& a, const V& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
V operator*(Real s, const V& a) {
    return {s * a.x, s * a.y, s * a.z};
}
Real dot(const V& a, const V& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
Real length(const V& a) {
    return std::sqrt(dot(a, a));
}
V wide(const Vec3& v) {
    return {static_cast<Real>(v.x), static_cast<Real>(v.y), static_cast<Real>(v.z)};
}

/// `v` by the quaternion's rotation, normalised.
V rotate(const Quat& q, const V& v) {
    const Real w = q.w, x = q.x, y = q.y, z = q.z, square = w * w + x * x + y * y + z * z;
    const V u{x, y, z};
    const V cross{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
    return (1 / square) * ((w * w - dot(u, u)) * v + 2 * dot(u, v) * u + 2 * w * cross);
}
Quat inverse(const Quat& q) {
    return {q.w, -q.x, -q.y, -q.z};
}

/// Balls, and boxes that are all turned alike, over one plane: what they are at is known in closed form.
struct World {
    Scene scene;
    Quat turn;

    const Shape& shape(std::uint32_t i) const { return scene.shape(scene.body({i}).shape); }
    V position(std::uint32_t i) const { return wide(scene.body({i}).pose.position); }
    bool is_plane(std::uint32_t i) const { return std::holds_alternative<Plane>(shape(i)); }

    /// How far body i reaches from its position along a direction.
    Real reach(std::uint32_t i, const V& direction) const {
        if (const auto* const ball = std::get_if<Sphere>(&shape(i))) return static_cast<Real>(ball->radius);
        const V h = wide(std::get<Box>(shape(i)).half_extents), d = rotate(inverse(turn), direction);
        return h.x * std::fabs(d.x) + h.y * std::fabs(d.y) + h.z * std::fabs(d.z);
    }

    /// The signed distance of two bodies.
    Real distance(std::uint32_t a, std::uint32_t b) const {
        if (is_plane(a) || is_plane(b)) {
            const std::uint32_t plane = is_plane(a) ? a : b, body = is_plane(a) ? b : a;
            const auto& p = std::get<Plane>(shape(plane));
            const V normal = wide(p.normal);
            const V up = (1 / length(normal)) * rotate(scene.body({plane}).pose.rotation, normal);
            return dot(up, position(body) - position(plane)) - static_cast<Real>(p.offset) / length(normal) -
                   reach(body, Real(-1) * up);
        }
        // In the frame that all boxes share, with balls as boxes without width and a radius.
        const V c = rotate(inverse(turn), position(b) - position(a));
        const auto half = [&](std::uint32_t i) {
            const auto* const box = std::get_if<Box>(&shape(i));
            return box == nullptr ? V{0, 0, 0} : wide(box->half_extents);
        };
        const auto radius = [&](std::uint32_t i) {
            const auto* const ball = std::get_if<Sphere>(&shape(i));
            return ball == nullptr ? Real(0) : static_cast<Real>(ball->radius);
        };
        const V h = half(a) + half(b);
        const Real beyond[3] = {std::fabs(c.x) - h.x, std::fabs(c.y) - h.y, std::fabs(c.z) - h.z};
        const Real largest = std::max({beyond[0], beyond[1], beyond[2]});
        Real square = 0;
        for (const Real d : beyond) square += d > 0 ? d * d : 0;
        return (largest > 0 ? std::sqrt(square) : largest) - radius(a) - radius(b);
    }
};

World random_world(std::size_t n, double at, test::Random& random) {
    World world;
    Quat& q = world.turn;
    q = {random.between(0.1, 1), random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
    const double size = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    q = {q.w / size, q.x / size, q.y / size, q.z / size};
    std::vector<ShapeId> shapes;
    for (int i = 0; i < 4; ++i) {
        shapes.push_back(world.scene.add_shape(Sphere{random.between(0.1, 0.6)}));
        shapes.push_back(
            world.scene.add_shape(Box{{random.between(0.1, 0.6), random.between(0.1, 0.6), random.between(0.1, 0.6)}}));
    }
    const double edge = 1.3 * std::cbrt(static_cast<double>(n));
    for (std::size_t i = 0; i < n; ++i) {
        Body body;
        body.shape = shapes[random.below(shapes.size())];
        body.pose.position = {at + random.between(0, edge), at + random.between(0, edge), random.between(0, edge)};
        body.pose.rotation = q;
        if (i % 5 == 0) body.motion = Motion::Static;
        if (i % 4 == 0) body.margin = random.between(0, 0.1);
        if (i == n / 2) body = Body{world.scene.add_shape(Plane{{0.0, 0.0, 1.0}, 0.5}), {{at, at, 0.0}, {}}};
        world.scene.add_body(body);
    }
    return world;
}

/// Every promise of a row, and that no pair within its margins is without one.
void check_contacts(const World& world, const StepResult& result) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, const Contact*> rows;
    std::size_t wrong_distance = 0, wrong_normal = 0, wrong_points = 0, needless = 0, missed = 0;
    const auto limit = [&](std::uint32_t a, std::uint32_t b) {
        return static_cast<Real>(world.scene.body({a}).margin) + static_cast<Real>(world.scene.body({b}).margin);
    };
    for (const Contact& c : result.contacts()) {
        rows[{c.a, c.b}] = &c;
        const Real truth = world.distance(c.a, c.b), error = static_cast<Real>(c.error);
        if (!(std::fabs(static_cast<Real>(c.distance) - truth) <= error)) ++wrong_distance;
        if (truth > limit(c.a, c.b) + 2 * error) ++needless;
        // Along the normal the bodies are as far apart, or as deep in each other, as the row says.
        const V n = wide(c.normal);
        if (std::fabs(length(n) - 1) > 1e-6L) ++wrong_normal;
        const Real scale = 1 + length(wide(c.on_a)), slack = error + 1e-6L + 1e-15L * scale;
        if (!world.is_plane(c.a) && !world.is_plane(c.b)) {
            const Real along = dot(n, world.position(c.b) - world.position(c.a)) - world.reach(c.a, n) -
                               world.reach(c.b, Real(-1) * n);
            if (std::fabs(along - static_cast<Real>(c.distance)) > slack) ++wrong_normal;
        }
        const V off = wide(c.on_b) - (wide(c.on_a) + static_cast<Real>(c.distance) * n);
        if (length(off) > 1e-15L * scale) ++wrong_points;
        // The point of A lies as far out along the normal as A reaches.
        if (!world.is_plane(c.a) && std::fabs(dot(n, wide(c.on_a) - world.position(c.a)) - world.reach(c.a, n)) > slack)
            ++wrong_points;
    }
    CHECK(rows.size() == result.contacts().size());
    for (const Pair& pair : result.pairs())
        if (world.distance(pair.a, pair.b) <= limit(pair.a, pair.b) && rows.count({pair.a, pair.b}) == 0) ++missed;
    CHECK(wrong_distance == 0);
    CHECK(wrong_normal == 0);
    CHECK(wrong_points == 0);
    CHECK(needless == 0);
    CHECK(missed == 0);
    CHECK(std::is_sorted(result.contacts().begin(), result.contacts().end(), [](const Contact& a, const Contact& b) {
        return Pair{a.a, a.b} < Pair{b.a, b.b};
    }));
    CHECK(result.report().contacts == rows.size());
    CHECK(result.narrow_report().contacts == rows.size());
    CHECK(result.narrow_report().pairs == result.pairs().size());
}

PipelineOptions with_contacts(double precision) {
    PipelineOptions options;
    options.contacts = true;
    options.narrow_phase.precision = precision;
    return options;
}

void check_precisions(Context& context, std::uint64_t seed, std::size_t count) {
    INFO("seed " << seed);
    test::Random random(seed);
    for (const double at : {0.0, 1e6}) {
        const World world = random_world(count, at, random);
        for (const double precision : {0.0, 0.5, 1.0}) {
            INFO("at " << at << ", precision " << precision);
            Pipeline pipeline(context, with_contacts(precision));
            const StepResult& result = pipeline.step(world.scene);
            CHECK(result.contacts().size() > count / 4);
            check_contacts(world, result);
        }
    }
}

bool same_rows(View<const Contact> a, const std::vector<Contact>& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const Contact& x, const Contact& y) {
               return x.a == y.a && x.b == y.b && x.feature == y.feature &&
                      std::memcmp(&x.on_a, &y.on_a, sizeof(Contact) - offsetof(Contact, on_a)) == 0;
           });
}

std::vector<Contact> copy_of(View<const Contact> contacts) {
    return {contacts.begin(), contacts.end()};
}

}  // namespace

TEST_CASE("contacts of balls and boxes on the host keep every promise", "[host]") {
    Context context = Context::host_only();
    check_precisions(context, 51, 600);
}

TEST_CASE("contacts of balls and boxes on a device keep every promise", "[device]") {
    Context context;
    check_precisions(context, 52, 2500);
}

TEST_CASE("few balls and boxes on a device", "[device][plain]") {
    Context context;
    test::Random random(53);
    const World world = random_world(250, 0.0, random);
    Pipeline pipeline(context, with_contacts(0.5));
    const StepResult& result = pipeline.step(world.scene);
    CHECK(result.pairs().size() > 128);
    check_contacts(world, result);
}

TEST_CASE("contacts are there only where they are asked for", "[host]") {
    test::Random random(54);
    const World world = random_world(300, 0.0, random);
    Context context = Context::host_only();
    Pipeline plain(context), full(context, with_contacts(0.5));
    const StepResult& without = plain.step(world.scene);
    CHECK(without.contacts().empty());
    CHECK(without.report().contacts == 0);
    CHECK(without.report().ms.narrow == 0.0);
    CHECK(without.narrow_report().pairs == 0);
    const StepResult& with = full.step(world.scene);
    CHECK(with.pairs().size() == without.pairs().size());
    CHECK(with.report().contacts > 0);
    CHECK(with.report().ms.narrow > 0.0);
    CHECK(with.report().ms.narrow <= with.report().ms.total);
    CHECK(with.report().peak_host_bytes >= without.report().peak_host_bytes + with.contacts().size() * sizeof(Contact));
}

TEST_CASE("a step that finds nothing changed keeps its contacts; one that does finds them anew", "[host]") {
    test::Random random(55);
    World world = random_world(400, 0.0, random);
    Context context = Context::host_only();
    Pipeline pipeline(context, with_contacts(0.5));
    const std::vector<Contact> first = copy_of(pipeline.step(world.scene).contacts());
    REQUIRE(first.size() > 50);
    const StepResult& again = pipeline.step(world.scene);
    CHECK(same_rows(again.contacts(), first));
    CHECK(again.report().contacts == first.size());
    CHECK(again.report().ms.narrow == 0.0);
    CHECK(again.narrow_report().ms.total == 0.0);
    CHECK(again.narrow_report().contacts == first.size());

    const Contact& some = first[first.size() / 2];
    const std::uint32_t moved = world.is_plane(some.a) ? some.b : some.a;
    Body body = world.scene.body({moved});
    body.pose.position.x += 0.01;
    world.scene.set_pose({moved}, body.pose);
    const StepResult& later = pipeline.step(world.scene);
    CHECK_FALSE(same_rows(later.contacts(), first));
    check_contacts(world, later);
    Pipeline fresh(context, with_contacts(0.5));
    CHECK(same_rows(later.contacts(), copy_of(fresh.step(world.scene).contacts())));
}

TEST_CASE("rows that miss the tolerance are counted", "[host]") {
    test::Random random(56);
    const World world = random_world(300, 0.0, random);
    Context context = Context::host_only();
    for (const double tolerance : {1e-30, 1.0}) {
        PipelineOptions options = with_contacts(0.5);
        options.narrow_phase.tolerance = tolerance;
        Pipeline pipeline(context, options);
        const StepResult& result = pipeline.step(world.scene);
        std::uint64_t above = 0;
        for (const Contact& c : result.contacts()) above += c.error > tolerance ? 1 : 0;
        CHECK(result.report().tolerance_missed == above);
        CHECK(result.narrow_report().tolerance_missed == above);
        CHECK(above == (tolerance < 1e-20 ? result.contacts().size() : 0));
    }
    PipelineOptions wrong = with_contacts(2.0);
    CHECK_THROWS_AS(Pipeline(context, wrong), Error);
    wrong.contacts = false;
    Pipeline unasked(context, wrong);
    CHECK(unasked.step(world.scene).pairs().size() > 0);
}

TEST_CASE("a pair with a mesh is an error, after which the pipeline goes on, events included", "[host]") {
    Scene scene;
    const ShapeId ball = scene.add_shape(Sphere{0.5});
    const ShapeId mesh = scene.add_shape(Mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
    scene.add_body({ball});
    scene.add_body({ball, {{0.9, 0, 0}, {}}});
    scene.add_body({mesh, {{9, 0, 0}, {}}});
    Context context = Context::host_only();
    PipelineOptions options = with_contacts(0.5);
    options.broad_phase.events = true;
    Pipeline pipeline(context, options);
    // A mesh that meets nobody is no pair.
    CHECK(pipeline.step(scene).contacts().size() == 1);
    scene.set_pose({2}, {{0, 0, 0}, {}});
    CHECK_THROWS_AS(pipeline.step(scene), Error);
    scene.set_pose({2}, {{0, 5, 0}, {}});
    scene.set_pose({1}, {{5, 0, 0}, {}});
    const StepResult& after = pipeline.step(scene);
    CHECK(after.contacts().empty());
    CHECK(after.report().contacts == 0);
    REQUIRE(after.removed().size() == 1);
    CHECK(after.removed()[0] == Pair{0, 1});
    CHECK(after.added().empty());
}
