#include "src/scene/convex_hull.hpp"

#include <libqhull_r/qhull_ra.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <cstdio>
#include <memory>
#include <tuple>

namespace clinch::detail {
namespace {

constexpr double unit_roundoff = 0x1p-53;

Vec3 minus(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
double dot(const Vec3& a, const Vec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Points moved to around the origin and scaled by a power of two to coordinates below 1/4, so that nothing
// overflows. Error: one rounding of each difference.
struct Normalized {
    std::vector<Vec3> points;
    int exponent = 0;  // of the scale
};

Normalized normalized(const std::vector<Vec3>& points) {
    Vec3 low = points.front(), high = low;
    for (const Vec3& p : points) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    // Halved first: the sum of two large coordinates may overflow, and so may their difference.
    const Vec3 middle{0.5 * low.x + 0.5 * high.x, 0.5 * low.y + 0.5 * high.y, 0.5 * low.z + 0.5 * high.z};
    double largest = 0.0;
    for (const Vec3& p : points) {
        const Vec3 d = minus(p, middle);
        largest = std::max({largest, std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)});
    }
    Normalized out;
    out.points.resize(points.size());
    std::frexp(largest, &out.exponent);
    out.exponent = -out.exponent - 2;
    const auto scale = [&](double d) { return std::ldexp(d, out.exponent); };
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3 d = minus(points[i], middle);
        out.points[i] = {scale(d.x), scale(d.y), scale(d.z)};
    }
    return out;
}

// Takes out of `points` what lies along the farthest of them; returns how far that one was.
double remove_farthest_direction(std::vector<Vec3>& points) {
    const auto farthest = std::max_element(points.begin(), points.end(),
                                           [](const Vec3& a, const Vec3& b) { return dot(a, a) < dot(b, b); });
    const double length = std::sqrt(dot(*farthest, *farthest));
    if (length == 0.0) return 0.0;
    const Vec3 d{farthest->x / length, farthest->y / length, farthest->z / length};
    for (Vec3& p : points) {
        const double t = dot(p, d);
        p = minus(p, {t * d.x, t * d.y, t * d.z});
    }
    return length;
}

// One plane of a hull: all of the facet's own vertices have normal . x >= inner.
struct Facet {
    Vec3 normal;
    double inner;
};

// One run of Qhull over points already normalized. Qhull is C with longjmp inside qh_new_qhull; no object with a
// destructor lives in between. What it would print goes to a file that keeps nothing.
class QhullRun {
public:
    // `options` are those of the program qhull, which takes them apart where they are.
    QhullRun(const std::vector<Vec3>& points, char* options) : points_(points), nowhere_(open_nowhere()) {
        if (!nowhere_ || points.size() > INT_MAX) return;
        qh_zero(&qhull_, nowhere_.get());
        // Qhull takes coordinates it may change only with other options than these.
        auto* coordinates = const_cast<coordT*>(&points.front().x);
        status_ = qh_new_qhull(&qhull_, 3, static_cast<int>(points.size()), coordinates, False, options, nullptr,
                               nowhere_.get());
        used_ = true;
    }
    ~QhullRun() {
        if (!used_) return;
        qh_freeqhull(&qhull_, !qh_ALL);
        int blocks = 0, bytes = 0;
        qh_memfreeshort(&qhull_, &blocks, &bytes);
    }
    QhullRun(const QhullRun&) = delete;
    QhullRun& operator=(const QhullRun&) = delete;

    bool ok() const { return used_ && status_ == 0; }

    // Marks vertices and points on or near a facet in `kept`, and gives every facet's plane.
    std::vector<Facet> facets(std::vector<char>& kept) const {
        std::vector<Facet> out;
        for_each_facet([&](const facetT* facet) {
            Facet f{{facet->normal[0], facet->normal[1], facet->normal[2]}, INFINITY};
            for_each(facet->vertices, [&](void* element) {
                const std::size_t i = index(static_cast<vertexT*>(element)->point);
                kept[i] = 1;
                f.inner = std::min(f.inner, dot(f.normal, points_[i]));
            });
            for_each(facet->coplanarset, [&](void* element) { kept[index(static_cast<pointT*>(element))] = 1; });
            out.push_back(f);
        });
        return out;
    }

    // Every facet's normal and vertices, in no order.
    std::vector<HullFace> faces() const {
        std::vector<HullFace> out;
        for_each_facet([&](const facetT* facet) {
            HullFace face{{facet->normal[0], facet->normal[1], facet->normal[2]}, 0.0, {}};
            for_each(facet->vertices, [&](void* element) {
                face.corners.push_back(static_cast<std::uint32_t>(index(static_cast<vertexT*>(element)->point)));
            });
            out.push_back(std::move(face));
        });
        return out;
    }

private:
    using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
    static File open_nowhere() {
#ifdef _WIN32
        return {std::fopen("NUL", "w"), &std::fclose};
#else
        return {std::fopen("/dev/null", "w"), &std::fclose};
#endif
    }
    template <class F>
    void for_each_facet(const F& use) const {
        for (const facetT* facet = qhull_.facet_list; facet != nullptr && facet->next != nullptr; facet = facet->next)
            use(facet);
    }
    template <class F>
    static void for_each(const setT* set, const F& use) {
        if (set == nullptr) return;
        for (const setelemT* e = set->e; e->p != nullptr; ++e) use(e->p);
    }
    std::size_t index(const pointT* point) const {
        return static_cast<std::size_t>(point - &points_.front().x) / 3;
    }

    const std::vector<Vec3>& points_;
    qhT qhull_{};
    File nowhere_;
    int status_ = -1;
    bool used_ = false;
};

// Proves that points lie inside a hull. The hull's facets are a closed surface of triangles between kept points,
// around `centre`. A point x with normal . x < inner for every facet is inside: the ray from centre through
// x leaves through a triangle, at a point y of normal . y >= inner; x and centre are below inner, so y
// is not between them. Any normals will do, so Qhull's own rounding does not matter.
class InsideTest {
public:
    // Usable only if ok().
    InsideTest(std::vector<Facet> facets, const Vec3& centre) : facets_(std::move(facets)), centre_(centre) {
        // Coordinates are below 1/4 with a rounding error of 2^-53 of that, of vertices and point alike;
        // a dot product with a unit normal is off by at most 6 units.
        constexpr double rounding = 32.0 * unit_roundoff;
        double radius = INFINITY;
        for (Facet& f : facets_) {
            f.inner -= rounding;
            radius = std::min(radius, f.inner - dot(f.normal, centre_));
        }
        ok_ = radius > 0.0 && std::isfinite(radius);
        // Below this the point is in the ball around centre that touches no facet.
        ball_ = radius > rounding ? (radius - rounding) * (radius - rounding) * (1.0 - rounding) : 0.0;
    }
    bool ok() const { return ok_; }
    bool operator()(const Vec3& x) const {
        const Vec3 d = minus(x, centre_);
        if (dot(d, d) < ball_) return true;
        return std::all_of(facets_.begin(), facets_.end(), [&](const Facet& f) { return dot(f.normal, x) < f.inner; });
    }

private:
    std::vector<Facet> facets_;
    Vec3 centre_;
    double ball_ = 0.0;
    bool ok_ = false;
};

// The middle of the kept points: strictly inside their hull when that has a volume.
Vec3 centre_of(const std::vector<Vec3>& points, const std::vector<char>& kept) {
    Vec3 sum;
    double count = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!kept[i]) continue;
        sum = {sum.x + points[i].x, sum.y + points[i].y, sum.z + points[i].z};
        count += 1.0;
    }
    return {sum.x / count, sum.y / count, sum.z / count};
}

Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Leaves the corners that make the face's outline, seen along its normal, in order [Andrew's monotone chain, 1979], and
// measures its thickness, times 2 to the `exponent`.
void make_face(const std::vector<Vec3>& points, HullFace& face, int exponent) {
    const Vec3& n = face.normal;
    const Vec3 away = std::fabs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 u = cross(away, n), v = cross(n, u);
    struct Flat {
        double x, y;
        std::uint32_t corner;
    };
    std::vector<Flat> flat;
    double low = INFINITY, high = -INFINITY;
    for (const std::uint32_t i : face.corners) {
        flat.push_back({dot(u, points[i]), dot(v, points[i]), i});
        low = std::min(low, dot(n, points[i]));
        high = std::max(high, dot(n, points[i]));
    }
    face.thickness = std::ldexp(high - low, exponent);
    std::sort(flat.begin(), flat.end(),
              [](const Flat& a, const Flat& b) { return std::tie(a.x, a.y, a.corner) < std::tie(b.x, b.y, b.corner); });
    std::vector<Flat> chain;
    const auto extend = [&](const Flat& p, std::size_t least) {
        while (chain.size() > least) {
            const Flat &b = chain.back(), &a = chain[chain.size() - 2];
            if ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) > 0.0) break;
            chain.pop_back();
        }
        chain.push_back(p);
    };
    for (const Flat& p : flat) extend(p, 1);
    const std::size_t lower = chain.size();
    for (std::size_t i = flat.size() - 1; i-- > 0;) extend(flat[i], lower);
    chain.pop_back();
    face.corners.clear();
    for (const Flat& p : chain) face.corners.push_back(p.corner);
}

// Facets as Qhull has them; none where it fails.
std::vector<HullFace> raw_faces(const std::vector<Vec3>& points, char* options) {
    const QhullRun run(points, options);
    if (!run.ok()) return {};
    return run.faces();
}

}  // namespace

bool spans_volume(const std::vector<Vec3>& points) {
    if (points.size() < 4) return false;
    auto [rest, exponent] = normalized(points);
    double largest = 0.0;
    for (const Vec3& p : points) largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    // How far rounding the given coordinates can have moved a point, in the normalized scale.
    const double noise = 64.0 * unit_roundoff * std::ldexp(largest, exponent);
    const Vec3 first = rest.front();
    for (Vec3& p : rest) p = minus(p, first);
    // Farthest point, then farthest from that line, then farthest from that plane.
    for (int direction = 0; direction < 3; ++direction) {
        if (!(remove_farthest_direction(rest) > noise)) return false;
    }
    return true;
}

std::vector<Vec3> outermost_points(std::vector<Vec3> points) {
    const auto key = [](const Vec3& p) { return std::tie(p.x, p.y, p.z); };
    std::sort(points.begin(), points.end(), [&](const Vec3& a, const Vec3& b) { return key(a) < key(b); });
    points.erase(
        std::unique(points.begin(), points.end(), [&](const Vec3& a, const Vec3& b) { return key(a) == key(b); }),
        points.end());
    if (points.size() < 5) return points;
    const std::vector<Vec3> scaled = normalized(points).points;
    char options[] = "qhull Qc Pp";
    const QhullRun run(scaled, options);
    if (!run.ok()) return points;
    std::vector<char> kept(points.size(), 0);
    std::vector<Facet> facets = run.facets(kept);
    const InsideTest inside(std::move(facets), centre_of(scaled, kept));
    if (!inside.ok()) return points;
    std::vector<Vec3> out;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (kept[i] || !inside(scaled[i])) out.push_back(points[i]);
    }
    return out;
}

std::vector<HullFace> hull_faces(const std::vector<Vec3>& points) {
    if (points.size() < 4) return {};
    const auto [scaled, exponent] = normalized(points);
    // Facets whose middles are within so much of their neighbours' planes are one; some hulls Qhull can only do
    // without.
    char merged[] = "qhull C-1e-6 Pp", all[] = "qhull Pp";
    std::vector<HullFace> faces = raw_faces(scaled, merged);
    if (faces.empty()) faces = raw_faces(scaled, all);
    for (HullFace& face : faces) make_face(scaled, face, -exponent);
    faces.erase(
        std::remove_if(faces.begin(), faces.end(), [](const HullFace& face) { return face.corners.size() < 3; }),
        faces.end());
    return faces;
}

}  // namespace clinch::detail
