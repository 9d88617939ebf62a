#include "src/scene/convex_hull.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <tuple>
#include <vector>

#include "tests/random.hpp"
#include "tests/scene/bounds_oracle.hpp"

using namespace clinch;
using test::Real;

namespace {

using Points = std::vector<Vec3>;

Vec3 in_cube(test::Random& random, double size) {
    return {random.between(-size, size), random.between(-size, size), random.between(-size, size)};
}

Vec3 on_sphere(test::Random& random, double radius) {
    const Quat q = test::random_rotation(random);
    const test::Real3 v = test::turned(q, {0, 0, 1});
    return {radius * double(v[0]), radius * double(v[1]), radius * double(v[2])};
}

Points make(std::size_t count, const std::function<Vec3()>& point) {
    Points points(count);
    std::generate(points.begin(), points.end(), point);
    return points;
}

Points cube_surface_grid(int n, double z_scale) {
    Points points;
    for (int x = 0; x <= n; ++x)
        for (int y = 0; y <= n; ++y)
            for (int z = 0; z <= n; ++z) {
                if (x % n != 0 && y % n != 0 && z % n != 0) continue;
                points.push_back({0.1 * x, 0.1 * y, 0.1 * z_scale * z});
            }
    return points;
}

Real support(const Points& points, const test::Real3& d) {
    Real best = -INFINITY;
    for (const Vec3& p : points) best = std::max(best, d[0] * p.x + d[1] * p.y + d[2] * p.z);
    return best;
}

// The kept points reach exactly as far as all of them, in random directions, along axes, and across edges.
void check_support(const Points& all, const Points& kept, test::Random& random) {
    Real largest = 0;
    for (const Vec3& p : all) largest = std::max<Real>(largest, std::fabs(p.x) + std::fabs(p.y) + std::fabs(p.z));
    for (int n = 0; n < 400; ++n) {
        test::Real3 d = test::turned(test::random_rotation(random), {0, 0, 1});
        if (n < 6) d = {n % 3 == 0 ? 1.0L : 0.0L, n % 3 == 1 ? 1.0L : 0.0L, n % 3 == 2 ? 1.0L : 0.0L};
        if (n < 3) d = {-d[0], -d[1], -d[2]};
        if (n >= 6 && n % 4 == 0) {  // straight out of a triangle of three given points
            const Vec3 &a = all[random.below(all.size())], &b = all[random.below(all.size())],
                       &c = all[random.below(all.size())];
            const test::Real3 u = {Real(b.x) - a.x, Real(b.y) - a.y, Real(b.z) - a.z};
            const test::Real3 v = {Real(c.x) - a.x, Real(c.y) - a.y, Real(c.z) - a.z};
            d = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
            const Real length = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            if (!(length > 0)) continue;
            for (Real& x : d) x /= length;
        }
        // All kept points are among the given ones, so only long double's own rounding may differ.
        CHECK(support(kept, d) >= support(all, d) - largest * 0x1p-62L);
    }
}

bool is_subset(const Points& kept, Points all) {
    const auto less = [](const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); };
    std::sort(all.begin(), all.end(), less);
    return std::is_sorted(kept.begin(), kept.end(), less) &&
           std::includes(all.begin(), all.end(), kept.begin(), kept.end(), less);
}

}  // namespace

TEST_CASE("outermost points reach as far as all points, on hostile sets", "[host]") {
    test::Random random(51);
    const auto check = [&](const char* name, const Points& all, std::size_t most) {
        INFO(name << ", " << all.size() << " points");
        const Points kept = detail::outermost_points(all);
        INFO("kept " << kept.size());
        CHECK(is_subset(kept, all));
        CHECK(kept.size() <= most);
        check_support(all, kept, random);
    };
    for (const double offset : {0.0, 1e6}) {
        for (const double size : {1.0, 1e-6, 1e30}) {
            const auto moved = [&](Vec3 p) { return Vec3{size * (p.x + offset), size * (p.y - offset), size * p.z}; };
            check("cube", make(3000, [&] { return moved(in_cube(random, 1)); }), 400);
            check("sphere", make(1000, [&] { return moved(on_sphere(random, 1)); }), 1000);
            check("shells", make(2000, [&] { return moved(on_sphere(random, 1 - 1e-3 * double(random.below(2)))); }),
                  1999);
            check("plate",
                  make(2000,
                       [&] {
                           Vec3 p = in_cube(random, 1);
                           p.z *= 1e-9;
                           return moved(p);
                       }),
                  2000);
            check("needle",
                  make(2000,
                       [&] {
                           Vec3 p = in_cube(random, 1);
                           return moved({p.x * 1e6, p.y, p.z});
                       }),
                  2000);
        }
    }
    check("nearly coplanar faces", cube_surface_grid(10, 1.0), 602);
    check("thin grid", cube_surface_grid(9, 1e-6), 600);
    Points noisy = cube_surface_grid(10, 1.0);
    for (Vec3& p : noisy) p.z += random.between(-1e-15, 1e-15);
    check("grid with rounding noise", noisy, noisy.size());
    Points slivers = make(1000, [&] {
        const double t = random.between(0, 1);
        return Vec3{t, t * t * 1e-8, random.between(0, 1e-12)};
    });
    check("slivers", slivers, slivers.size());
}

TEST_CASE("duplicates go, few or flat points stay", "[host]") {
    Points cube;
    for (int i = 0; i < 8; ++i) cube.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2)});
    Points doubled = cube;
    for (int n = 0; n < 9; ++n) doubled.insert(doubled.end(), cube.begin(), cube.end());
    doubled.push_back({0.5, 0.5, 0.5});
    CHECK(detail::outermost_points(doubled).size() == 8);
    test::Random random(52);
    const Points flat = make(100, [&] { return Vec3{random.between(0, 1), random.between(0, 1), 0.0}; });
    CHECK(detail::outermost_points(flat).size() == 100);
    const Points line = make(100, [&] { return Vec3{random.between(0, 1), 0.0, 0.0}; });
    CHECK(detail::outermost_points(line).size() == 100);
    CHECK(detail::outermost_points(Points(40, Vec3{1, 2, 3})).size() == 1);
    CHECK(detail::outermost_points({}).empty());
    CHECK(detail::outermost_points({{1, 2, 3}, {4, 5, 6}}).size() == 2);
}

TEST_CASE("points span a volume or lie in one plane", "[host]") {
    test::Random random(53);
    using detail::spans_volume;
    CHECK_FALSE(spans_volume({}));
    CHECK_FALSE(spans_volume({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    CHECK_FALSE(spans_volume(Points(10, Vec3{1e7, 2, 3})));
    for (int n = 0; n < 300; ++n) {
        INFO("run " << n);
        const double size = std::pow(10.0, random.between(-30, 30)), offset = random.below(2) == 0 ? 0.0 : 1e4;
        const double thin = std::pow(10.0, random.between(-8, 0)), long_ = std::pow(10.0, random.between(0, 6));
        const Quat q = test::random_rotation(random);
        const auto place = [&](const Vec3& p) {
            const test::Real3 v = test::turned(q, {p.x * long_, p.y, p.z});
            return Vec3{size * (double(v[0]) + offset), size * double(v[1]), size * (double(v[2]) - offset)};
        };
        const auto solid = make(4 + random.below(20), [&] {
            const Vec3 p = in_cube(random, 1);
            return place({p.x, p.y, p.z * (offset + long_ > 1e3 ? std::max(thin, 1e-3) : thin)});
        });
        const auto flat = make(4 + random.below(20), [&] {
            const Vec3 p = in_cube(random, 1);
            return place({p.x, p.y, 0.0});
        });
        CHECK(spans_volume(solid));
        CHECK_FALSE(spans_volume(flat));
    }
}
