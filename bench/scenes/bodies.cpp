#include "bench/scenes/bodies.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "bench/scenes/falling.hpp"
#include "bench/scenes/random.hpp"
#include "clinch/error.hpp"

namespace clinch::scenes {
namespace {

struct KindRow {
    BodyKind kind;
    Scene (*make)(std::size_t count, std::uint64_t seed);
};

// The bodies of `mix`: all shapes but planes and meshes, a few of each class, which bodies share.
class MixShapes {
public:
    MixShapes(Scene& scene, Random& random) : scene_(scene), random_(random) {
        for (std::size_t i = 0; i < of_class; ++i) {
            ids_[0][i] = scene.add_shape(Sphere{length(0.2, 0.5)});
            ids_[1][i] = scene.add_shape(Box{{length(0.15, 0.45), length(0.15, 0.45), length(0.15, 0.45)}});
            ids_[2][i] = scene.add_shape(Capsule{length(0.1, 0.3), length(0.1, 0.5)});
            ids_[3][i] = scene.add_shape(Cylinder{length(0.15, 0.45), length(0.15, 0.45)});
            ids_[4][i] = scene.add_shape(Cone{length(0.2, 0.5), length(0.2, 0.5)});
            ids_[5][i] = scene.add_shape(hull(8 + 8 * i));
        }
    }
    /// Any class is as likely as any other.
    ShapeId any() {
        const std::size_t kind = random_.below(ids_.size());
        return ids_[kind][random_.below(of_class)];
    }

private:
    static constexpr std::size_t of_class = 8;

    // Thousandths, so that scene files stay short.
    static double thousandths(double x) { return std::floor(1000.0 * x + 0.5) / 1000.0; }
    double length(double low, double high) { return thousandths(random_.between(low, high)); }

    // Points of an ellipsoid so far apart that each is a corner of the hull, also when rounded.
    Hull hull(std::size_t corners) {
        const double axes[3] = {length(0.3, 0.5), length(0.3, 0.5), length(0.3, 0.5)};
        std::vector<std::array<double, 3>> directions;
        Hull made;
        // Caps around the points fill a quarter of the sphere: there is room for one more until the end.
        const double nearest = 4.0 / static_cast<double>(corners);
        while (made.points.size() < corners) {
            const std::array<double, 3> d = random_.direction();
            bool free = true;
            for (const auto& e : directions) {
                const double x = d[0] - e[0], y = d[1] - e[1], z = d[2] - e[2];
                free = free && x * x + y * y + z * z >= nearest;
            }
            if (!free) continue;
            directions.push_back(d);
            made.points.push_back(
                {thousandths(axes[0] * d[0]), thousandths(axes[1] * d[1]), thousandths(axes[2] * d[2])});
        }
        return made;
    }

    Scene& scene_;
    Random& random_;
    std::array<std::array<ShapeId, of_class>, 6> ids_{};
};

// Body 0 is a plane below the others. Two bodies touch with the probability (2 V + M S / (2 pi)) / edge^3 (V, S, M:
// mean volume, surface and integral of the mean curvature; the kinematic formula of integral geometry), here reach /
// edge^3, so that a body touches about one other.
Scene make_mix(std::size_t count, std::uint64_t seed) {
    constexpr double reach = 1.6;
    Scene scene;
    if (count == 0) return scene;
    Random random(seed);
    Body plane;
    plane.shape = scene.add_shape(Plane{{0.0, 0.0, 1.0}, 0.0});
    plane.motion = Motion::Static;
    scene.add_body(plane);
    MixShapes shapes(scene, random);
    const double edge = cube_root(reach * static_cast<double>(count));
    for (std::size_t i = 1; i < count; ++i) {
        Body body;
        body.shape = shapes.any();
        body.pose.position.x = random.between(0.0, edge);
        body.pose.position.y = random.between(0.0, edge);
        body.pose.position.z = random.between(0.0, edge);
        const std::array<double, 4> q = random.unit_vector<4>();
        body.pose.rotation = {q[0], q[1], q[2], q[3]};
        scene.add_body(body);
    }
    return scene;
}

constexpr std::array<KindRow, 1> kinds{{
    {{"mix",
      "bodies of every shape but meshes, turned at random, in a cube above a plane; a body touches about one other"},
     make_mix},
}};

}  // namespace

std::vector<BodyKind> body_kinds() {
    const std::vector<FallingKind> falling = falling_kinds();
    std::vector<BodyKind> all;
    all.reserve(kinds.size() + falling.size());
    for (const KindRow& row : kinds) all.push_back(row.kind);
    for (const FallingKind& row : falling) all.push_back(row.kind);
    return all;
}

Scene make_bodies(const std::string& kind, std::size_t count, std::uint64_t seed) {
    std::string known;
    for (const KindRow& row : kinds) {
        if (kind == row.kind.name) return row.make(count, seed);
        known += (known.empty() ? "" : ", ") + std::string(row.kind.name);
    }
    for (const FallingKind& falling : falling_kinds()) {
        if (kind == falling.kind.name) return FallingBodies(kind, count, seed).scene();
        known += ", " + std::string(falling.kind.name);
    }
    throw Error(ErrorCode::InvalidArgument, "'" + kind + "' is no kind of scene of bodies; " + known + " are accepted");
}

}  // namespace clinch::scenes
