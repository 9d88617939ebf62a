#include "bench/accuracy/difference_hull.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace clinch::accuracy {
namespace {

constexpr int most_points = 300;
constexpr int most_without_gain = 16;

struct Facet {
    std::array<std::size_t, 3> corner;
    Real3 normal;  // outward, unit
    Real offset;
};

/// The point of a hull's surface nearest to another one.
struct Nearest {
    Real distance = std::numeric_limits<Real>::infinity();
    /// Both from the inside outward: that of the way between the points, exact where it is long, and that of the facet
    /// or across the edge, exact where those are not slivers.
    Real3 by_way{}, by_feature{};
};

class Hull {
public:
    /// Starts with a tetrahedron; without a volume it has no facets.
    explicit Hull(const Difference& pair);
    bool empty() const { return facets_.empty(); }
    Real size() const { return size_; }
    /// A closed surface of triangles has twice as many as corners, less 4: more have been torn by rounding.
    bool torn() const { return facets_.size() > 2 * points_.size(); }
    /// Of q inside the hull the distance is negative.
    Nearest nearest(const Real3& q) const;
    /// Takes p in. False where it is no farther out than rounding, or would make a facet without area.
    bool add(const Real3& p);

private:
    std::optional<Facet> facet_of(std::size_t i, std::size_t j, std::size_t k) const;
    void look_at_triangle(const Facet& facet, const Real3& q, Nearest& best) const;
    static void look_at_edge(const Real3& p, const Real3& r, const Real3& q, Nearest& best);

    std::vector<Real3> points_;
    std::vector<Facet> facets_;
    Real size_ = 0;
};

Hull::Hull(const Difference& pair) {
    const auto farthest = [&](const auto& value, const std::vector<Real3>& directions) {
        Real3 best{};
        Real most = -1;
        for (const Real3& n : directions) {
            const Real3 p = pair.point(n);
            if (value(p) > most) {
                most = value(p);
                best = p;
            }
        }
        points_.push_back(best);
        return most;
    };
    std::vector<Real3> around;
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z)
                if (x != 0 || y != 0 || z != 0) around.push_back({Real(x), Real(y), Real(z)});
    size_ = farthest([](const Real3& p) { return length(p); }, around);
    farthest([&](const Real3& p) { return length(minus(p, points_[0])); }, around);
    const Real3 edge = unit(minus(points_[1], points_[0]));
    const auto off_edge = [&](const Real3& p) { return length(cross(edge, minus(p, points_[0]))); };
    // Across the edge, and then across the triangle: so that thin bodies give their thickness too.
    const Real3 side = unit(cross(edge, std::fabs(edge[0]) < 0.6L ? Real3{1, 0, 0} : Real3{0, 1, 0}));
    const Real3 other = cross(edge, side);
    farthest(off_edge, {side, other, {-side[0], -side[1], -side[2]}, {-other[0], -other[1], -other[2]}});
    const Real3 up = cross(minus(points_[1], points_[0]), minus(points_[2], points_[0]));
    if (!(length(up) > 0)) return;
    const Real3 n = unit(up);
    const Real high =
        farthest([&](const Real3& p) { return std::fabs(dot(n, minus(p, points_[0]))); }, {n, {-n[0], -n[1], -n[2]}});
    if (!(high > 1e-15L * size_)) return;
    for (std::size_t left = 0; left < 4; ++left) {
        const std::size_t i = (left + 1) % 4, j = (left + 2) % 4, k = (left + 3) % 4;
        std::optional<Facet> facet = facet_of(i, j, k);
        if (facet && dot(facet->normal, points_[left]) > facet->offset) facet = facet_of(i, k, j);
        if (!facet) {
            facets_.clear();
            return;
        }
        facets_.push_back(*facet);
    }
}

std::optional<Facet> Hull::facet_of(std::size_t i, std::size_t j, std::size_t k) const {
    const Real3 u = minus(points_[j], points_[i]), v = minus(points_[k], points_[i]);
    const Real3 n = cross(u, v);
    const Real area = length(n);
    if (!(area > 1e-18L * length(u) * length(v))) return std::nullopt;
    const Real3 normal = unit(n);
    return Facet{{i, j, k}, normal, dot(normal, points_[i])};
}

void Hull::look_at_edge(const Real3& p, const Real3& r, const Real3& q, Nearest& best) {
    const Real3 e = minus(r, p);
    const Real ee = dot(e, e);
    const Real t = std::clamp<Real>(dot(minus(q, p), e) / ee, 0, 1);
    const Real3 way = minus(q, along(p, t, e));
    const Real distance = length(way);
    if (!(distance > 0 && distance < best.distance)) return;
    Real3 across = way;
    if (t > 0 && t < 1)
        for (int i = 0; i < 2; ++i) across = along(across, -dot(across, e) / ee, e);
    best = {distance, unit(way), length(across) > 0 ? unit(across) : unit(way)};
}

// Heights above a sliver's plane mean little: what counts is a point of the triangle itself.
void Hull::look_at_triangle(const Facet& facet, const Real3& q, Nearest& best) const {
    const Real height = dot(facet.normal, q) - facet.offset;
    if (std::fabs(height) >= best.distance) return;
    const Real3 foot = along(q, -height, facet.normal);
    std::array<Real, 3> part{};
    Real sum = 0;
    bool inside = true;
    for (std::size_t i = 0; i < 3; ++i) {
        const Real3 &p = points_[facet.corner[i]], &r = points_[facet.corner[(i + 1) % 3]];
        part[(i + 2) % 3] = dot(cross(minus(r, p), minus(foot, p)), facet.normal);
        sum += part[(i + 2) % 3];
        if (part[(i + 2) % 3] >= 0) continue;
        inside = false;
        look_at_edge(p, r, q, best);
    }
    if (!inside || !(sum > 0)) return;
    Real3 way = q;
    for (std::size_t i = 0; i < 3; ++i) way = along(way, -part[i] / sum, points_[facet.corner[i]]);
    const Real distance = length(way);
    if (!(distance < best.distance)) return;
    const Real3 up = height < 0 ? Real3{-facet.normal[0], -facet.normal[1], -facet.normal[2]} : facet.normal;
    best = {distance, distance > 0 ? unit(way) : up, up};
}

Nearest Hull::nearest(const Real3& q) const {
    Nearest best;
    Real top = -std::numeric_limits<Real>::infinity();
    for (const Facet& facet : facets_) {
        top = std::max(top, dot(facet.normal, q) - facet.offset);
        look_at_triangle(facet, q, best);
    }
    if (top > 0) return best;
    for (Real3* n : {&best.by_way, &best.by_feature}) *n = {-(*n)[0], -(*n)[1], -(*n)[2]};
    best.distance = -best.distance;
    return best;
}

bool Hull::add(const Real3& p) {
    std::vector<Facet> kept;
    std::vector<std::pair<std::size_t, std::size_t>> edges;  // of facets that p sees
    for (const Facet& f : facets_) {
        if (dot(f.normal, p) - f.offset <= 1e-18L * size_) {
            kept.push_back(f);
            continue;
        }
        for (std::size_t i = 0; i < 3; ++i) edges.emplace_back(f.corner[i], f.corner[(i + 1) % 3]);
    }
    if (edges.empty()) return false;
    points_.push_back(p);
    // An edge whose other side is not seen is one of the horizon.
    for (const auto& e : edges) {
        if (std::find(edges.begin(), edges.end(), std::make_pair(e.second, e.first)) != edges.end()) continue;
        const std::optional<Facet> facet = facet_of(e.first, e.second, points_.size() - 1);
        if (!facet) {
            points_.pop_back();
            return false;
        }
        kept.push_back(*facet);
    }
    facets_ = std::move(kept);
    return true;
}

}  // namespace

Bounds bounds_of(const Difference& pair) {
    Hull hull(pair);
    Bounds bounds;
    bounds.low = -std::numeric_limits<Real>::infinity();
    bounds.high = std::numeric_limits<Real>::infinity();
    if (hull.empty()) return bounds;
    const Real size = hull.size() + length(pair.between) + pair.balls();
    Real narrowest = bounds.high;
    int without_gain = 0;
    for (int i = 0; i < most_points && without_gain < most_without_gain && !hull.torn(); ++i) {
        const Nearest nearest = hull.nearest(pair.between);
        bounds.high = std::min(bounds.high, nearest.distance - pair.balls());
        const Real by_way = pair.apart(nearest.by_way), by_feature = pair.apart(nearest.by_feature);
        const Real3& direction = by_way > by_feature ? nearest.by_way : nearest.by_feature;
        if (std::max(by_way, by_feature) > bounds.low) {
            bounds.low = std::max(by_way, by_feature);
            bounds.normal = direction;
        }
        const Real width = bounds.high - bounds.low;
        without_gain = width < 0.9L * narrowest ? 0 : without_gain + (width < 1e-12L * size ? 1 : 0);
        narrowest = std::min(narrowest, width);
        if (width <= 2e-18L * size || !hull.add(pair.point(direction))) break;
    }
    // Facets of the last points are so small that their planes are off by this; between bodies of unlike sizes all
    // facets are thin.
    const Real a = pair.a.size(), b = pair.b.size();
    const Real planes_off = std::max(a, b) > 30 * std::min(a, b) ? 2e-14L : 2e-15L;
    bounds.high = std::max(bounds.high, bounds.low) + planes_off * size;
    return bounds;
}

}  // namespace clinch::accuracy
