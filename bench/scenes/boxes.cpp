#include "bench/scenes/boxes.hpp"

#include <utility>

#include "clinch/error.hpp"

namespace clinch::scenes {
namespace {

// In the order of BoxGenerator::Kind.
constexpr std::array<BoxKind, 5> kinds{{
    {"uniform", "centres uniform in a 20^3 cube, sides 0.01 to 1; about 0.9 M pairs at 100,000"},
    {"cubes", "cubes of side 0.5 in a 20^3 cube; about 0.6 n pairs at 10,000"},
    {"density", "cubes of side 1 in a cube that grows with n; about n pairs"},
    {"mixed", "planets and debris in a 50^3 cube: every thousandth side 1 to 20, the others 0.01 to 0.1"},
    {"clusters", "cubes of side 1 in 20 Gaussian clusters; about 4 n pairs"},
}};

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
    : kind_(find(kind)), random_(seed) {
    const double n = static_cast<double>(count);
    switch (kind_) {
        case Kind::Uniform:
        case Kind::Cubes:
            edge_ = 20.0;
            break;
        case Kind::Density:  // two unit cubes overlap with probability (2 / edge)^3
            edge_ = cube_root(4.0 * n);
            break;
        case Kind::Mixed:
            edge_ = 50.0;
            break;
        case Kind::Clusters:  // two unit cubes of one cluster overlap with probability 1 / (sqrt(pi) deviation)^3
            deviation_ = cube_root(n / 160.0) / 1.7724538509055160273;
            place_clusters();
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

BoxGenerator::Centre BoxGenerator::anywhere() {
    Centre c{};
    c.x = random_.between(0.0, edge_);
    c.y = random_.between(0.0, edge_);
    c.z = random_.between(0.0, edge_);
    return c;
}

BoxGenerator::Centre BoxGenerator::in_cluster(const Centre& middle) {
    Centre c{};
    c.x = middle.x + deviation_ * random_.gaussian();
    c.y = middle.y + deviation_ * random_.gaussian();
    c.z = middle.z + deviation_ * random_.gaussian();
    return c;
}

Aabb BoxGenerator::box(const Centre& c, double side) {
    const double half = 0.5 * side;
    return {{static_cast<float>(c.x - half), static_cast<float>(c.y - half), static_cast<float>(c.z - half)},
            {static_cast<float>(c.x + half), static_cast<float>(c.y + half), static_cast<float>(c.z + half)}};
}

Aabb BoxGenerator::next() {
    const std::uint64_t i = made_++;
    if (kind_ == Kind::Clusters) return box(in_cluster(clusters_[i % cluster_count]), 1.0);
    const Centre centre = anywhere();
    switch (kind_) {
        case Kind::Uniform:
            return box(centre, random_.between(0.01, 1.0));
        case Kind::Cubes:
            return box(centre, 0.5);
        case Kind::Mixed:
            return box(centre, i % 1000 == 0 ? random_.between(1.0, 20.0) : random_.between(0.01, 0.1));
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
