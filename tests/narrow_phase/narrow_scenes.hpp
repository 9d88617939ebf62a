// Scenes for tests of the narrow phase, and what answers must satisfy.
#pragma once

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <utility>
#include <vector>

#include "clinch/narrow_phase.hpp"
#include "tests/random.hpp"

namespace clinch::test {

inline Quat random_rotation(Random& random) {
    for (;;) {
        Quat q{random.between(-1, 1), random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)};
        const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
        if (length > 0.1 && length < 1.0) return {q.w / length, q.x / length, q.y / length, q.z / length};
    }
}

/// A shape of class `kind` (its index in Shape), about 1 across.
inline Shape random_shape(std::size_t kind, Random& random) {
    const auto size = [&] { return random.between(0.1, 0.6); };
    switch (kind) {
        case 0:
            return Sphere{size()};
        case 1:
            return Box{{size(), size(), size()}};
        case 2:
            return Capsule{size(), random.below(4) == 0 ? 0.0 : size()};
        case 3:
            return Cylinder{size(), size()};
        case 4:
            return Cone{size(), size()};
        case 5: {
            const double angle = random.between(0, 6.28);
            return Plane{{0.6 * std::cos(angle), 0.6 * std::sin(angle), 0.8}, random.between(-0.5, 0.5)};
        }
        default: {
            Hull hull;
            for (std::uint64_t i = 0, n = 4 + random.below(40); i < n; ++i)
                hull.points.push_back(
                    {random.between(-0.5, 0.5), random.between(-0.5, 0.5), random.between(-0.5, 0.5)});
            return hull;
        }
    }
}

/// n bodies of every class that has routines, each with a shape of its own or a shared one, in a cube of the given edge
/// around `centre`; every tenth pair of neighbours in number shares its place or its rotation.
inline Scene random_bodies(std::size_t n, double edge, Vec3 centre, Random& random) {
    Scene scene;
    std::vector<ShapeId> shared;
    for (std::size_t i = 0; i < n; ++i) {
        Body body;
        if (i % 3 != 0 || shared.empty()) shared.push_back(scene.add_shape(random_shape(random.below(7), random)));
        body.shape = shared[i % 3 != 0 ? shared.size() - 1 : random.below(shared.size())];
        body.pose.position = {centre.x + random.between(0, edge), centre.y + random.between(0, edge),
                              centre.z + random.between(0, edge)};
        body.pose.rotation = random_rotation(random);
        const BodyId id = scene.add_body(body);
        if (i > 0 && i % 10 == 0) {
            Pose pose = body.pose;
            const Pose before = scene.body({id.index - 1}).pose;
            if (i % 20 == 0) pose.position = before.position;
            if (i % 30 != 0) pose.rotation = before.rotation;
            scene.set_pose(id, pose);
        }
    }
    return scene;
}

/// Bodies of a few classes, so that few kernels are built, and a plane.
inline Scene few_classes(std::size_t n, std::uint64_t seed) {
    Random random(seed);
    Scene scene;
    std::vector<ShapeId> shapes;
    for (const std::size_t kind : {0u, 1u, 1u, 2u, 6u}) shapes.push_back(scene.add_shape(random_shape(kind, random)));
    scene.add_body({scene.add_shape(Plane{{0, 0, 1}, 0.3}), Pose{}});
    const double edge = 0.7 * std::cbrt(static_cast<double>(n));
    for (std::size_t i = 0; i < n; ++i) {
        Body body;
        body.shape = shapes[i % shapes.size()];
        body.pose.position = {random.between(0, edge), random.between(0, edge), random.between(0, edge)};
        body.pose.rotation = random_rotation(random);
        body.margin = i % 7 == 0 ? 0.05 : 0.0;
        body.group = i % 11 == 0 ? 2u : 1u;
        scene.add_body(body);
    }
    return scene;
}

/// Moves and turns every ninth body, but the first.
inline void move_some(Scene& scene, std::uint64_t seed) {
    Random random(seed);
    for (std::uint32_t i = 1; i < scene.row_count(); i += 9) {
        Pose pose = scene.body({i}).pose;
        pose.position.x += random.between(-0.1, 0.1);
        pose.rotation = random_rotation(random);
        scene.set_pose({i}, pose);
    }
}

/// All pairs a < b of bodies, but those of two planes.
inline std::vector<Pair> all_pairs(const Scene& scene) {
    const auto is_plane = [&](std::uint32_t row) {
        return std::holds_alternative<Plane>(scene.shape({scene.columns().shape[row]}));
    };
    std::vector<Pair> pairs;
    const auto n = static_cast<std::uint32_t>(scene.row_count());
    for (std::uint32_t a = 0; a < n; ++a)
        for (std::uint32_t b = a + 1; b < n; ++b)
            if (!is_plane(a) || !is_plane(b)) pairs.push_back({a, b});
    return pairs;
}

inline NarrowPhaseOptions with_precision(double precision) {
    NarrowPhaseOptions options;
    options.precision = precision;
    return options;
}

/// The contacts of a call, the report's counts checked.
inline std::vector<Contact> found(NarrowPhase& narrow, const Scene& scene, const std::vector<Pair>& pairs,
                                  WarmStart* warm = nullptr) {
    const View<const Contact> contacts = narrow.find(scene, pairs, warm);
    CHECK(narrow.report().pairs == pairs.size());
    CHECK(narrow.report().contacts == contacts.size());
    return {contacts.begin(), contacts.end()};
}
/// Those of a narrow phase of its own.
inline std::vector<Contact> found(Context& context, const NarrowPhaseOptions& options, const Scene& scene,
                                  const std::vector<Pair>& pairs) {
    NarrowPhase narrow(context, options);
    return found(narrow, scene, pairs);
}

inline bool same_bytes(const std::vector<Contact>& p, const std::vector<Contact>& q) {
    return p.size() == q.size() && (p.empty() || std::memcmp(p.data(), q.data(), p.size() * sizeof p[0]) == 0);
}

inline std::map<std::pair<std::uint32_t, std::uint32_t>, Contact> by_pair(View<const Contact> contacts) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, Contact> out;
    for (const Contact& c : contacts) out[{c.a, c.b}] = c;
    return out;
}

}  // namespace clinch::test
