// A small software renderer: parallel projection, depth buffer, smooth shading, outlines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tools/draw/parts.hpp"

namespace clinch::draw {

struct Colour {
    float r = 0, g = 0, b = 0;  ///< 0 to 1, as stored in a PNG
};

/// Part of a picture in pixels, y downward.
struct Rectangle {
    int x = 0, y = 0, width = 0, height = 0;
};

/// Looks along a direction without perspective.
class Camera {
public:
    /// Sees along `direction` (world) with `up` (world) upward in the picture, and fits the parts and their boxes
    /// with a margin into `width` samples and as many rows as they need, `max_height` at most.
    Camera(const Vec3& direction, const Vec3& up, const std::vector<Part>& parts, int width, int max_height);
    int width() const noexcept { return width_; }
    int height() const noexcept { return height_; }
    /// x and y in samples, y downward; z grows away from the viewer, in samples as well.
    Vec3 project(const Vec3& world) const;
    /// A direction in the frame of the picture: x right, y up, z toward the viewer.
    Vec3 turn(const Vec3& world) const;

private:
    int width_, height_;
    Vec3 right_, up_, forward_;
    double scale_ = 1, x_ = 0, y_ = 0;
};

/// Samples of one layer of the picture; several make a pixel.
class Layer {
public:
    /// Nothing yet, of the camera's size.
    explicit Layer(const Camera& camera);

    /// Draws a part; `id` (from 0) tells parts apart where outlines are made.
    void draw(const Part& part, const Camera& camera, const Colour& colour, std::int32_t id);
    /// Darkens corners that little light reaches, judged by the depth around each sample.
    void darken_corners(int radius);
    /// Draws a dark line of `thickness` samples where parts or depths part.
    void outline(int thickness, float strength);
    /// Draws the edges of a part's box, thin where the layer hides them.
    void draw_box(const Part& part, const Camera& camera, const Colour& colour, double thickness);

    int width() const noexcept { return width_; }
    int height() const noexcept { return height_; }
    bool covered(std::size_t sample) const noexcept { return coverage_[sample] > 0; }
    const Colour& colour(std::size_t sample) const noexcept { return colour_[sample]; }
    /// How much of what lies behind a sample it hides, 0 to 1.
    float coverage(std::size_t sample) const noexcept { return coverage_[sample]; }

private:
    struct Projected {
        Vec3 position, normal;
    };
    void draw_triangle(const Projected (&corner)[3], const Colour& colour, std::int32_t id);
    void draw_line(const Vec3& from, const Vec3& to, const Colour& colour, double thickness);
    void blend(int x, int y, const Colour& colour, float opacity);
    std::size_t at(int x, int y) const noexcept {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    }

    int width_, height_;
    std::vector<Colour> colour_;
    std::vector<float> depth_;
    std::vector<float> coverage_;
    std::vector<std::int32_t> id_;
};

}  // namespace clinch::draw
