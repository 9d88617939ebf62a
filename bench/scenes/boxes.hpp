// Generated sets of boxes: what tests check, benchmarks time and `clinch scene` writes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/scenes/random.hpp"
#include "bench/scenes/surface.hpp"
#include "clinch/aabb.hpp"

namespace clinch::scenes {

/// A kind of box scene: its name and one line on what it is. Both strings are static.
struct BoxKind {
    const char* name;
    const char* what;
    bool all_pairs;  ///< every box overlaps every other: 40 GB of pairs at 100,000
};

/// All kinds, in the order that help texts list them.
std::vector<BoxKind> box_kinds();

/// Makes the boxes of a scene one by one, in constant memory. The boxes depend on kind, count and seed
/// alone: the same bytes on every machine.
class BoxGenerator {
public:
    /// An unknown kind is Error InvalidArgument, which lists the known ones.
    BoxGenerator(const std::string& kind, std::uint64_t count, std::uint64_t seed);

    /// The next of `count` boxes: world space, min <= max, computed in float64 and rounded to the nearest
    /// float32. O(1). May be called `count` times.
    Aabb next();

private:
    struct Centre {
        double x, y, z;
    };
    static Aabb box(const Centre& centre, double side);
    static Aabb box(const Centre& centre, const Centre& sides);
    Centre anywhere();
    Centre in_cluster(const Centre& middle);
    Centre needle_sides();
    Aabb on_floor();
    Aabb in_grid(std::uint64_t i) const;
    Aabb of_surface(std::uint64_t i) const;
    void set_edge(double n);
    void place_clusters();
    void place_grid();
    void place_surfaces();

    // In the order of the table in boxes.cpp.
    enum class Kind {
        Uniform,
        Cubes,
        Density,
        Mixed,
        Clusters,
        Surface,
        Plane,
        Line,
        Identical,
        GridTouch,
        Far,
        Far6,
        SparseMotion
    };
    static Kind find(const std::string& name);

    static constexpr std::size_t cluster_count = 20;
    Kind kind_;
    std::uint64_t count_;
    Random random_;
    std::uint64_t made_ = 0;
    double edge_ = 0.0;       // of the cube or square that centres are uniform in; of the grid
    double deviation_ = 0.0;  // of a cluster
    std::array<Centre, cluster_count> clusters_{};
    Centre origin_{};                            // where the scene is, or the one box
    std::uint64_t first_cell_ = 0, stride_ = 1;  // the walk through the grid's cells
    std::array<BumpySurface, 2> surfaces_{};
};

/// All boxes of a scene at once, 24 bytes each. Errors as BoxGenerator.
std::vector<Aabb> make_boxes(const std::string& kind, std::size_t count, std::uint64_t seed);

}  // namespace clinch::scenes
