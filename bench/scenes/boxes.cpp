#include "bench/scenes/boxes.hpp"

#include <cmath>
#include <numeric>
#include <utility>

#include "clinch/error.hpp"

namespace clinch::scenes {
namespace {

// In the order of BoxGenerator::Kind.
constexpr std::array<BoxKind, 13> kinds{{
    {"uniform", "centres uniform in a 20^3 cube, sides 0.01 to 1; about 0.9 M pairs at 100,000", false},
    {"cubes", "cubes of side 0.5 in a 20^3 cube; about 0.6 n pairs at 10,000", false},
    {"density", "cubes of side 1 in a cube that grows with n; about n pairs", false},
    {"mixed", "planets and debris in a 50^3 cube: every thousandth side 1 to 20, the others 0.01 to 0.1", false},
    {"clusters", "cubes of side 1 in 20 Gaussian clusters; about 4 n pairs", false},
    {"surface", "boxes of the triangles of two bumpy spheres that cut each other; about 6 n pairs", false},
    {"plane", "cubes of side 0.5 to 1.5 on one floor, all overlapping on z; about 2 n pairs", false},
    {"line", "needles 10 long and 0.01 thick in random directions; about 4 n pairs of their boxes", false},
    {"identical", "one unit box n times: all n (n - 1) / 2 pairs", true},
    {"grid-touch", "unit boxes on a cubic grid whose faces touch exactly, in mixed order; about 13 n pairs", false},
    {"far", "density, 1e7 from the origin on each axis, where float32 has a spacing of 1", false},
    {"far6", "density, 1e6 from the origin on each axis", false},
    {"sparse-motion", "the first frame of density with some boxes moving; the same boxes as density", false},
}};

constexpr double far_from_origin = 1e7, less_far_from_origin = 1e6;

}  // namespace

std::vector<BoxKind> box_kinds() {
    return {kinds.begin(), kinds.end()};
}

BoxGenerator::Kind BoxGenerator::find(const std::string& name) {
    std::string known;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
        if (name == kinds[i].name) return static_cast<Kind>(i);
        known += (i == 0 ? "" : ", ") + std::string(kinds[i].name);
    }
    throw Error(ErrorCode::InvalidArgument, "'" + name + "' is no kind of box scene; " + known + " are accepted");
}

BoxGenerator::BoxGenerator(const std::string& kind, std::uint64_t count, std::uint64_t seed)
    : kind_(find(kind)), count_(count), random_(seed) {
    set_edge(static_cast<double>(count));
    switch (kind_) {
        case Kind::Clusters:
            place_clusters();
            break;
        case Kind::Surface:
            place_surfaces();
            break;
        case Kind::Identical:
            edge_ = 100.0;
            origin_ = anywhere();
            break;
        case Kind::GridTouch:
            place_grid();
            break;
        case Kind::Far:
            origin_ = {far_from_origin, -far_from_origin, far_from_origin};
            break;
        case Kind::Far6:
            origin_ = {less_far_from_origin, -less_far_from_origin, less_far_from_origin};
            break;
        default:
            break;
    }
}

void BoxGenerator::set_edge(double n) {
    switch (kind_) {
        case Kind::Uniform:
        case Kind::Cubes:
            edge_ = 20.0;
            break;
        case Kind::Density:  // two unit cubes overlap with probability (2 / edge)^3
        case Kind::Far:
        case Kind::Far6:
        case Kind::SparseMotion:
            edge_ = cube_root(4.0 * n);
            break;
        case Kind::Mixed:
            edge_ = 50.0;
            break;
        case Kind::Clusters:  // two unit cubes of one cluster overlap with probability 1 / (sqrt(pi) deviation)^3
            deviation_ = cube_root(n / 160.0) / 1.7724538509055160273;
            break;
        case Kind::Plane:  // two sides p and q overlap with probability ((p + q) / edge)^2, on average 25/6 / edge^2
            edge_ = std::sqrt(25.0 / 24.0 * n);
            break;
        case Kind::Line:  // boxes of unit needles overlap with probability 0.796 / edge^3
            edge_ = 10.0 * cube_root(n / 10.0);
            break;
        default:
            break;
    }
}

/// Puts the clusters into 20 of 27 cells, moved a little off the middle. Bodies lie within 6
/// deviations of a cluster's centre on each axis and centres are 12 deviations and a side apart,
/// so that clusters never mix.
void BoxGenerator::place_clusters() {
    std::array<int, 27> cells{};
    for (int i = 0; i < 27; ++i) cells[static_cast<std::size_t>(i)] = i;
    for (std::size_t i = cells.size() - 1; i > 0; --i) std::swap(cells[i], cells[random_.below(i + 1)]);
    const double shift = 2.0 * deviation_ + 1.0;
    const double pitch = 12.0 * deviation_ + 2.0 * shift + 2.0;
    for (std::size_t i = 0; i < cluster_count; ++i) {
        const int column = cells[i] % 3, row = cells[i] / 3 % 3, layer = cells[i] / 9;
        Centre& c = clusters_[i];
        c.x = pitch * column + random_.between(-shift, shift);
        c.y = pitch * row + random_.between(-shift, shift);
        c.z = pitch * layer + random_.between(-shift, shift);
    }
}

/// The smallest cube of cells that holds all boxes, of which the first `count` are filled; they are visited in
/// steps that share no factor with `count`, so that each comes once and neighbours in space are none in order.
void BoxGenerator::place_grid() {
    if (count_ == 0) return;
    auto edge = static_cast<std::uint64_t>(cube_root(static_cast<double>(count_)));
    while (edge * edge * edge < count_) ++edge;
    edge_ = static_cast<double>(edge);
    origin_.x = static_cast<double>(random_.below(2001)) - 1000.0;
    origin_.y = static_cast<double>(random_.below(2001)) - 1000.0;
    origin_.z = static_cast<double>(random_.below(2001)) - 1000.0;
    first_cell_ = random_.below(count_);
    do stride_ = 1 + random_.below(count_);
    while (std::gcd(stride_, count_) != 1);
}

/// Half of the boxes each; centres 1.8 radii apart, so that the surfaces cut each other in a ring.
void BoxGenerator::place_surfaces() {
    const std::uint64_t half = count_ - count_ / 2;
    const double apart = 1.8 * BumpySurface::radius(half);
    const std::array<double, 3> direction = random_.direction();
    surfaces_[0] = BumpySurface(random_, half, {0.0, 0.0, 0.0});
    surfaces_[1] =
        BumpySurface(random_, count_ / 2, {apart * direction[0], apart * direction[1], apart * direction[2]});
}

BoxGenerator::Centre BoxGenerator::anywhere() {
    Centre c{};
    c.x = origin_.x + random_.between(0.0, edge_);
    c.y = origin_.y + random_.between(0.0, edge_);
    c.z = origin_.z + random_.between(0.0, edge_);
    return c;
}

BoxGenerator::Centre BoxGenerator::in_cluster(const Centre& middle) {
    Centre c{};
    c.x = middle.x + deviation_ * random_.gaussian();
    c.y = middle.y + deviation_ * random_.gaussian();
    c.z = middle.z + deviation_ * random_.gaussian();
    return c;
}

/// The box around a needle of any direction, thickness a thousandth of its length.
BoxGenerator::Centre BoxGenerator::needle_sides() {
    constexpr double length = 10.0, thickness = 0.01;
    const auto r = random_.rotation();
    const auto side = [&](std::size_t d) {
        return length * std::fabs(r[d][0]) + thickness * (std::fabs(r[d][1]) + std::fabs(r[d][2]));
    };
    return {side(0), side(1), side(2)};
}

Aabb BoxGenerator::on_floor() {
    Centre c{};
    c.x = random_.between(0.0, edge_);
    c.y = random_.between(0.0, edge_);
    const double side = random_.between(0.5, 1.5);
    c.z = 0.5 * side;
    return box(c, side);
}

Aabb BoxGenerator::in_grid(std::uint64_t i) const {
    const auto edge = static_cast<std::uint64_t>(edge_);
    const std::uint64_t cell = (first_cell_ + i % count_ * stride_) % count_;
    const std::uint64_t column = cell % edge, row = cell / edge % edge, layer = cell / edge / edge;
    return box({origin_.x + static_cast<double>(column) + 0.5, origin_.y + static_cast<double>(row) + 0.5,
                origin_.z + static_cast<double>(layer) + 0.5},
               1.0);
}

Aabb BoxGenerator::of_surface(std::uint64_t i) const {
    const std::uint64_t first = count_ - count_ / 2;
    return i < first ? surfaces_[0].triangle_box(i) : surfaces_[1].triangle_box(i - first);
}

Aabb BoxGenerator::box(const Centre& c, double side) {
    return box(c, Centre{side, side, side});
}

Aabb BoxGenerator::box(const Centre& c, const Centre& sides) {
    const double x = 0.5 * sides.x, y = 0.5 * sides.y, z = 0.5 * sides.z;
    return {{static_cast<float>(c.x - x), static_cast<float>(c.y - y), static_cast<float>(c.z - z)},
            {static_cast<float>(c.x + x), static_cast<float>(c.y + y), static_cast<float>(c.z + z)}};
}

Aabb BoxGenerator::next() {
    const std::uint64_t i = made_++;
    switch (kind_) {
        case Kind::Clusters:
            return box(in_cluster(clusters_[i % cluster_count]), 1.0);
        case Kind::Surface:
            return of_surface(i);
        case Kind::Plane:
            return on_floor();
        case Kind::Identical:
            return box(origin_, 1.0);
        case Kind::GridTouch:
            return in_grid(i);
        default:
            break;
    }
    const Centre centre = anywhere();
    switch (kind_) {
        case Kind::Uniform:
            return box(centre, random_.between(0.01, 1.0));
        case Kind::Cubes:
            return box(centre, 0.5);
        case Kind::Mixed:
            return box(centre, i % 1000 == 0 ? random_.between(1.0, 20.0) : random_.between(0.01, 0.1));
        case Kind::Line:
            return box(centre, needle_sides());
        default:
            return box(centre, 1.0);
    }
}

std::vector<Aabb> make_boxes(const std::string& kind, std::size_t count, std::uint64_t seed) {
    BoxGenerator generator(kind, count, seed);
    std::vector<Aabb> boxes(count);
    for (Aabb& b : boxes) b = generator.next();
    return boxes;
}

}  // namespace clinch::scenes
