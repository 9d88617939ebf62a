#include "bench/scenes/falling_ground.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace clinch::scenes {
namespace {

double dot(const Vec3& a, const Vec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

std::array<Vec3, 3> rows(const Quat& q) {
    return {{{1.0 - 2.0 * (q.y * q.y + q.z * q.z), 2.0 * (q.x * q.y - q.w * q.z), 2.0 * (q.x * q.z + q.w * q.y)},
             {2.0 * (q.x * q.y + q.w * q.z), 1.0 - 2.0 * (q.x * q.x + q.z * q.z), 2.0 * (q.y * q.z - q.w * q.x)},
             {2.0 * (q.x * q.z - q.w * q.y), 2.0 * (q.y * q.z + q.w * q.x), 1.0 - 2.0 * (q.x * q.x + q.y * q.y)}}};
}

}  // namespace

double Outline::bound() const {
    double square = 0.0;
    for (const Vec3& corner : corners) square = std::max(square, dot(corner, corner));
    return std::sqrt(square) + round;
}

double Ground::height(const Outline& outline, const Quat& rotation, double x, double y) const {
    const std::array<Vec3, 3> turn = rows(rotation);
    const double inner = radius - outline.round;
    double highest = -std::numeric_limits<double>::infinity();
    for (const Vec3& corner : outline.corners) {
        double lowest = outline.round;
        if (radius > 0.0) {
            const double u = x + dot(turn[0], corner), v = y + dot(turn[1], corner);
            lowest = radius - std::sqrt(std::max(0.0, inner * inner - u * u - v * v));
        }
        highest = std::max(highest, lowest - dot(turn[2], corner));
    }
    return highest;
}

bool Ground::holds(double x, double y, double bound) const {
    if (!(radius > 0.0)) return true;
    const double limit = 0.95 * radius - bound;
    return limit >= 0.0 && x * x + y * y <= limit * limit;
}

double reach_below(const Outline& outline, const Quat& rotation) {
    return Ground{}.height(outline, rotation, 0.0, 0.0);
}

Quat product(const Quat& a, const Quat& b) {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

Quat normalised(const Quat& q) {
    const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return {q.w / length, q.x / length, q.y / length, q.z / length};
}

}  // namespace clinch::scenes
