#include "tools/draw/render.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tools/draw/vector.hpp"

namespace clinch::draw {

namespace {

constexpr float nothing = std::numeric_limits<float>::infinity();

Colour scaled(const Colour& c, float s) {
    return {c.r * s, c.g * s, c.b * s};
}

// Light from the upper left, a weaker one from the right, the sky above, and a soft highlight.
Colour shade(const Colour& base, Vec3 normal) {
    if (normal.z < 0) normal = -1.0 * normal;  // the inner side of an open surface
    const Vec3 key = unit({-0.45, 0.75, 0.65});
    const Vec3 fill = unit({0.8, 0.1, 0.5});
    const double light =
        0.60 + 0.42 * std::max(0.0, dot(normal, key)) + 0.16 * std::max(0.0, dot(normal, fill)) + 0.07 * normal.y;
    const double shine = 0.16 * std::pow(std::max(0.0, dot(normal, unit(key + Vec3{0, 0, 1}))), 24.0);
    const auto channel = [&](float c) { return static_cast<float>(std::clamp(c * light + shine, 0.0, 1.0)); };
    return {channel(base.r), channel(base.g), channel(base.b)};
}

std::array<Vec3, 8> box_corners(const Part& part) {
    std::array<Vec3, 8> corners;
    for (std::size_t i = 0; i < 8; ++i)
        corners[i] = {(i & 1) != 0 ? part.max.x : part.min.x, (i & 2) != 0 ? part.max.y : part.min.y,
                      (i & 4) != 0 ? part.max.z : part.min.z};
    return corners;
}

}  // namespace

Camera::Camera(const Vec3& direction, const Vec3& up, const std::vector<Part>& parts, int width, int max_height)
    : width_(width), height_(max_height), forward_(unit(direction)) {
    right_ = unit(cross(forward_, up));
    up_ = cross(right_, forward_);
    double low[2] = {1e300, 1e300};
    double high[2] = {-1e300, -1e300};
    for (const Part& part : parts) {
        if (part.triangles.empty()) continue;
        for (const Vec3& corner : box_corners(part)) {
            const double p[2] = {dot(right_, corner), dot(up_, corner)};
            for (int k = 0; k < 2; ++k) {
                low[k] = std::min(low[k], p[k]);
                high[k] = std::max(high[k], p[k]);
            }
        }
    }
    if (low[0] > high[0]) return;  // nothing to see
    constexpr double margin = 0.95;
    const double wide = std::max(high[0] - low[0], 1e-300);
    const double tall = std::max(high[1] - low[1], 1e-300);
    scale_ = margin * std::min(width / wide, max_height / tall);
    height_ = static_cast<int>(std::ceil(scale_ * tall / margin));
    x_ = 0.5 * (width - scale_ * (low[0] + high[0]));
    y_ = 0.5 * (height_ + scale_ * (low[1] + high[1]));
}

Vec3 Camera::project(const Vec3& world) const {
    return {x_ + scale_ * dot(right_, world), y_ - scale_ * dot(up_, world), scale_ * dot(forward_, world)};
}

Vec3 Camera::turn(const Vec3& world) const {
    return {dot(right_, world), dot(up_, world), -dot(forward_, world)};
}

Layer::Layer(const Camera& camera) : width_(camera.width()), height_(camera.height()) {
    const std::size_t count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    colour_.assign(count, Colour{1, 1, 1});
    depth_.assign(count, nothing);
    coverage_.assign(count, 0.0f);
    id_.assign(count, -1);
}

void Layer::draw(const Part& part, const Camera& camera, const Colour& colour, std::int32_t id) {
    for (const Triangle& triangle : part.triangles) {
        Projected corner[3];
        for (std::size_t i = 0; i < 3; ++i)
            corner[i] = {camera.project(triangle[i].position), camera.turn(triangle[i].normal)};
        draw_triangle(corner, colour, id);
    }
}

void Layer::draw_triangle(const Projected (&corner)[3], const Colour& colour, std::int32_t id) {
    const Vec3& a = corner[0].position;
    const Vec3& b = corner[1].position;
    const Vec3& c = corner[2].position;
    const double area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    if (area == 0) return;
    const int x0 = std::max(0, static_cast<int>(std::floor(std::min({a.x, b.x, c.x}))));
    const int x1 = std::min(width_ - 1, static_cast<int>(std::ceil(std::max({a.x, b.x, c.x}))));
    const int y0 = std::max(0, static_cast<int>(std::floor(std::min({a.y, b.y, c.y}))));
    const int y1 = std::min(height_ - 1, static_cast<int>(std::ceil(std::max({a.y, b.y, c.y}))));
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const double px = x + 0.5;
            const double py = y + 0.5;
            const double u = ((b.x - px) * (c.y - py) - (c.x - px) * (b.y - py)) / area;
            const double v = ((c.x - px) * (a.y - py) - (a.x - px) * (c.y - py)) / area;
            const double w = 1 - u - v;
            if (u < 0 || v < 0 || w < 0) continue;
            const auto depth = static_cast<float>(u * a.z + v * b.z + w * c.z);
            const std::size_t sample = at(x, y);
            if (depth >= depth_[sample]) continue;
            depth_[sample] = depth;
            id_[sample] = id;
            coverage_[sample] = 1;
            colour_[sample] = shade(colour, unit(u * corner[0].normal + v * corner[1].normal + w * corner[2].normal));
        }
}

void Layer::darken_corners(int radius) {
    std::vector<float> light(colour_.size(), 1.0f);
    constexpr int rays = 12;
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
            const std::size_t sample = at(x, y);
            if (id_[sample] < 0) continue;
            float hidden = 0;
            for (int k = 0; k < rays; ++k) {
                // A spiral, turned from sample to sample; the mean over a pixel's samples is smooth.
                const double angle = 2.399963 * k + 1.7 * ((x * 7 + y * 13) % 9);
                const double reach = radius * std::sqrt((k + 0.5) / rays);
                const int nx = x + static_cast<int>(std::lround(reach * std::cos(angle)));
                const int ny = y + static_cast<int>(std::lround(reach * std::sin(angle)));
                if (nx < 0 || ny < 0 || nx >= width_ || ny >= height_) continue;
                const float nearer = depth_[sample] - depth_[at(nx, ny)];
                const auto far = static_cast<float>(4 * radius);
                if (nearer > 0.5f && nearer < far)
                    hidden += std::min(1.0f, nearer / static_cast<float>(reach)) * (1 - nearer / far);
            }
            light[sample] = 1 - 0.62f * std::min(1.0f, 1.4f * hidden / rays);
        }
    for (std::size_t i = 0; i < light.size(); ++i) colour_[i] = scaled(colour_[i], light[i]);
}

void Layer::outline(int thickness, float strength) {
    std::vector<std::uint8_t> edge(colour_.size(), 0);
    const auto step = static_cast<float>(3 * thickness);
    for (int y = thickness; y < height_ - thickness; ++y)
        for (int x = thickness; x < width_ - thickness; ++x) {
            const std::size_t sample = at(x, y);
            if (id_[sample] < 0) continue;
            const std::array<std::size_t, 4> around = {at(x - thickness, y), at(x + thickness, y), at(x, y - thickness),
                                                       at(x, y + thickness)};
            for (std::size_t k = 0; k < 4; ++k) {
                // A slope goes on beyond the sample, a step does not: the depths on both sides tell.
                const float bend = depth_[around[k]] + depth_[around[k ^ 1]] - 2 * depth_[sample];
                if (id_[around[k]] != id_[sample] ? depth_[around[k]] >= depth_[sample] : bend > step) edge[sample] = 1;
            }
        }
    for (std::size_t i = 0; i < edge.size(); ++i)
        if (edge[i] != 0) colour_[i] = scaled(colour_[i], 1 - strength);
}

void Layer::blend(int x, int y, const Colour& colour, float opacity) {
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
    const std::size_t sample = at(x, y);
    const float behind = coverage_[sample] * (1 - opacity);
    const float all = opacity + behind;
    Colour& old = colour_[sample];
    old = {(colour.r * opacity + old.r * behind) / all, (colour.g * opacity + old.g * behind) / all,
           (colour.b * opacity + old.b * behind) / all};
    coverage_[sample] = all;
}

void Layer::draw_line(const Vec3& from, const Vec3& to, const Colour& colour, double thickness) {
    const double dx = to.x - from.x;
    const double dy = to.y - from.y;
    const double square = dx * dx + dy * dy;
    const double half = thickness / 2;
    const int x0 = static_cast<int>(std::floor(std::min(from.x, to.x) - half));
    const int x1 = static_cast<int>(std::ceil(std::max(from.x, to.x) + half));
    const int y0 = static_cast<int>(std::floor(std::min(from.y, to.y) - half));
    const int y1 = static_cast<int>(std::ceil(std::max(from.y, to.y) + half));
    for (int y = std::max(0, y0); y <= std::min(height_ - 1, y1); ++y)
        for (int x = std::max(0, x0); x <= std::min(width_ - 1, x1); ++x) {
            const double px = x + 0.5 - from.x;
            const double py = y + 0.5 - from.y;
            const double t = square > 0 ? std::clamp((px * dx + py * dy) / square, 0.0, 1.0) : 0.0;
            const double ox = px - t * dx;
            const double oy = py - t * dy;
            if (ox * ox + oy * oy > half * half) continue;
            const bool hidden = from.z + t * (to.z - from.z) > static_cast<double>(depth_[at(x, y)]);
            blend(x, y, colour, hidden ? 0.22f : 0.85f);
        }
}

void Layer::draw_box(const Part& part, const Camera& camera, const Colour& colour, double thickness) {
    const std::array<Vec3, 8> corners = box_corners(part);
    for (std::size_t i = 0; i < 8; ++i)
        for (const std::size_t bit : {1u, 2u, 4u})
            if ((i & bit) == 0)
                draw_line(camera.project(corners[i]), camera.project(corners[i | bit]), colour, thickness);
}

}  // namespace clinch::draw
