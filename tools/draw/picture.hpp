// The finished picture: layers put together, text, and the PNG file.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tools/draw/render.hpp"

namespace clinch::draw {

/// Letters of a TrueType font.
class Font {
public:
    /// Reads a font file; one that is missing or no TrueType font is io::InputError.
    explicit Font(const std::string& path);
    ~Font();
    Font(Font&& other) noexcept;

private:
    friend class Picture;
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Pixels, white at first.
class Picture {
public:
    Picture(int width, int height);
    int width() const noexcept { return width_; }
    int height() const noexcept { return height_; }

    /// Lays a layer of `samples` x `samples` samples a pixel over the picture with its upper left
    /// corner at pixel (x, y); `opacity` 0 to 1.
    void put(const Layer& layer, int samples, int x, int y, float opacity);
    void fill(const Rectangle& where, const Colour& colour);
    /// Writes printable ASCII with its base line at `y`, letters `size` pixels high from the lowest to
    /// the highest; returns the x where it ends.
    int write(const Font& font, const std::string& text, int x, int y, float size, const Colour& colour);

    /// Writes a PNG file, complete or not at all. Errors as io::OutputFile.
    void save(const std::string& path) const;

private:
    void blend(int x, int y, const Colour& colour, float opacity);
    int width_, height_;
    std::vector<Colour> pixels_;
};

}  // namespace clinch::draw
