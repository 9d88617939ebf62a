#include "bench/scenes/falling_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "bench/scenes/falling.hpp"
#include "bench/scenes/falling_pile.hpp"
#include "bench/scenes/falling_shapes.hpp"
#include "bench/scenes/random.hpp"
#include "clinch/error.hpp"

namespace clinch::scenes {
namespace {

std::size_t edge_of_square(std::size_t cells) {
    auto edge = static_cast<std::size_t>(std::sqrt(static_cast<double>(cells)));
    while (edge * edge < cells) ++edge;
    return std::max<std::size_t>(edge, 1);
}

void add_hull(Draft& draft, Hull hull) {
    Outline outline{hull.points, 0.0};
    draft.add_shape(std::move(hull), std::move(outline));
}

void cubes_on_plane(Draft& draft) {
    constexpr double half = 0.5;
    const Pile pile{1.2, 0.98, 0.0};
    Outline cube;
    for (const double x : {-half, half})
        for (const double y : {-half, half})
            for (const double z : {-half, half}) cube.corners.push_back({x, y, z});
    draft.add_static(draft.plan.scene.add_shape(Plane{{0.0, 0.0, 1.0}, 0.0}), {});
    draft.add_shape(Box{{half, half, half}}, std::move(cube));
    fill(draft, square_of_columns(edge_of_square((draft.count - 1 + 3) / 4), pile.pitch), pile, 0.0);
}

// A column of hulls between each cone and the next ones in x and y; a cone reaches up to the third layer and a little
// into the hulls beside it.
void tori_onto_cones(Draft& draft) {
    constexpr double radius = 0.3, half_height = 0.5;
    const Pile pile{1.25, 0.42, 0.06};
    draft.add_static(draft.plan.scene.add_shape(Plane{{0.0, 0.0, 1.0}, 0.0}), {});
    const std::vector<Column> columns = square_of_columns(edge_of_square((draft.count - 1) / 5), pile.pitch);
    const std::size_t cones = std::min(columns.size(), (draft.count - 1) / 2);
    const ShapeId cone = draft.plan.scene.add_shape(Cone{radius, half_height});
    for (std::size_t i = 0; i < cones; ++i)
        draft.add_static(cone, {{columns[i].x + 0.5 * pile.pitch, columns[i].y + 0.5 * pile.pitch, half_height}, {}});
    add_hull(draft, torus_hull());
    fill(draft, columns, pile, 2.0 * half_height);
}

// Turns (x, y) by the golden angle, which no few turns bring back to where they began.
std::array<double, 2> turned(const std::array<double, 2>& v) {
    constexpr double cosine = -0.7373688780783197, sine = 0.6754902942615238;
    const double x = cosine * v[0] - sine * v[1], y = sine * v[0] + cosine * v[1];
    const double length = std::sqrt(x * x + y * y);
    return {x / length, y / length};
}

// Boxes along a spiral from the lowest point of a ball up to `rim` of its radius, each with the same part of the area,
// large enough to leave no hole. A face lies a little inside the ball's surface at its middle and as much outside where
// the next takes over: bodies at rest reach a little into some and not quite to others.
void add_bowl(Draft& draft, std::size_t pieces, double rim) {
    constexpr double two_pi = 6.283185307179586477, thickness = 0.5, cover = 0.8;
    const double radius = draft.plan.ground.radius;
    const double side = radius * std::sqrt(two_pi * rim / static_cast<double>(pieces));
    const double slope = std::min(0.5, 0.7 * side / radius);  // of a piece's plane where the next takes over
    const double face = radius * (1.0 - 0.25 * slope * slope);
    const ShapeId piece = draft.plan.scene.add_shape(Box{{cover * side, cover * side, 0.5 * thickness}});
    std::array<double, 2> around{1.0, 0.0};
    for (std::size_t k = 0; k < pieces; ++k, around = turned(around)) {
        const double up = 1.0 - rim * static_cast<double>(k) / static_cast<double>(pieces);
        const double out = std::sqrt(std::max(0.0, 1.0 - up * up));
        const Vec3 inward{-out * around[0], -out * around[1], up};
        const double middle = face + 0.5 * thickness;
        const Vec3 position{-middle * inward.x, -middle * inward.y, radius - middle * inward.z};
        draft.add_static(piece, {position, normalised({1.0 + inward.z, -inward.y, inward.x, 0.0})});
    }
}

// The columns whose bodies lie within the bowl's mouth; that of the axis always does.
std::vector<Column> columns_of_bowl(const Draft& draft, const Pile& pile) {
    const FallPlan& plan = draft.plan;
    const double bound = draft.bound();
    const auto reach = static_cast<std::uint32_t>(plan.ground.radius / pile.pitch) + 1;
    std::vector<Column> columns;
    for (std::uint32_t j = 0; j <= 2 * reach; ++j)
        for (std::uint32_t i = 0; i <= 2 * reach; ++i) {
            const double x = pile.pitch * (static_cast<double>(i) - reach);
            const double y = pile.pitch * (static_cast<double>(j) - reach);
            if (!plan.ground.holds(x, y, bound + 0.06 * pile.pitch)) continue;
            double floor = 0.0;
            for (const Outline& outline : plan.outlines)
                floor += plan.ground.height(outline, {}, x, y) - reach_below(outline, {});
            floor /= static_cast<double>(plan.outlines.size());
            columns.push_back({x, y, floor, i % 2 + 2 * (j % 2)});
        }
    return columns;
}

// As many pieces as keep the bowl round to within a fixed part of a body.
void into_bowl(Draft& draft, const Pile& pile) {
    constexpr double rim = 0.8;
    const double edge = cube_root(static_cast<double>(draft.count));
    const std::size_t pieces =
        std::min(draft.count / 4 + 1, static_cast<std::size_t>(std::max(300.0, std::floor(14.0 * edge))));
    // A ball's cap as high as 0.6 of its radius has 0.9 radius^3.
    const double volume = static_cast<double>(draft.count - pieces) * pile.pitch * pile.pitch * pile.layer;
    const double bound = draft.bound();
    draft.plan.ground.radius = std::max(2.5 * bound, bound + cube_root(volume / 0.9));
    add_bowl(draft, pieces, rim);
    fill(draft, columns_of_bowl(draft, pile), pile, rim * draft.plan.ground.radius);
}

void balls_in_bowl(Draft& draft) {
    constexpr double radius = 0.5;
    draft.add_shape(Sphere{radius}, Outline{{Vec3{}}, radius});
    into_bowl(draft, {0.97, 0.97, 0.0});
}

void letters_in_bowl(Draft& draft) {
    for (std::size_t letter = 0; letter < letter_count; ++letter) add_hull(draft, letter_hull(letter));
    into_bowl(draft, {0.9, 0.3, 0.12});
}

struct KindRow {
    FallingKind falling;
    void (*plan)(Draft& draft);
};

constexpr std::array<KindRow, 4> kinds{{
    {{{"cubes-on-plane", "cubes of side 1 in a loose cloud above a plane, about to fall"}, 20001}, cubes_on_plane},
    {{{"balls-in-bowl", "spheres in a loose cloud above a bowl of boxes, about to fall"}, 10304}, balls_in_bowl},
    {{{"tori-hulls",
       "convex hulls of tori in a loose cloud above a field of cones on a plane, about to fall; they stand in for "
       "meshes"},
      1257},
     tori_onto_cones},
    {{{"alphabet-hulls",
       "convex hulls of the 26 capital letters, extruded, in a loose cloud above a bowl of boxes, about to fall; they "
       "stand in for meshes"},
      2900},
     letters_in_bowl},
}};

}  // namespace

std::vector<FallingKind> falling_kinds() {
    std::vector<FallingKind> all;
    all.reserve(kinds.size());
    for (const KindRow& row : kinds) all.push_back(row.falling);
    return all;
}

FallPlan plan_fall(const std::string& kind, std::size_t count, std::uint64_t seed) {
    std::string known;
    for (const KindRow& row : kinds) {
        known += (known.empty() ? "" : ", ") + std::string(row.falling.kind.name);
        if (kind != row.falling.kind.name) continue;
        Draft draft{{}, {}, Random(seed), count};
        if (count > 0) row.plan(draft);
        return std::move(draft.plan);
    }
    throw Error(ErrorCode::InvalidArgument, "'" + kind + "' is no kind of falling scene; " + known + " are accepted");
}

}  // namespace clinch::scenes
