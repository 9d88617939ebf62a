#include "tools/draw/picture.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <stb/stb_image_write.h>
#include <stb/stb_truetype.h>

#include "tools/io/error.hpp"
#include "tools/io/input_file.hpp"
#include "tools/io/output_file.hpp"

namespace clinch::draw {

struct Font::Impl {
    std::string data;  // info points into it
    stbtt_fontinfo info{};
};

Font::Font(const std::string& path) : impl_(std::make_unique<Impl>()) {
    impl_->data = io::read_text(path);
    const auto* const bytes = reinterpret_cast<const unsigned char*>(impl_->data.data());
    // The library does not check lengths; the first four bytes keep out what is no font at all.
    const bool font = impl_->data.size() > 12 && stbtt_GetNumberOfFonts(bytes) > 0 &&
                      stbtt_InitFont(&impl_->info, bytes, stbtt_GetFontOffsetForIndex(bytes, 0)) != 0;
    if (!font) throw io::InputError(path + " is no TrueType font");
}
Font::~Font() = default;
Font::Font(Font&& other) noexcept = default;

Picture::Picture(int width, int height) : width_(width), height_(height) {
    pixels_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), Colour{1, 1, 1});
}

void Picture::blend(int x, int y, const Colour& colour, float opacity) {
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
    Colour& old = pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
    old = {old.r + (colour.r - old.r) * opacity, old.g + (colour.g - old.g) * opacity,
           old.b + (colour.b - old.b) * opacity};
}

void Picture::put(const Layer& layer, int samples, int x, int y, float opacity) {
    const auto row = static_cast<std::size_t>(layer.width());
    for (int py = 0; py < layer.height() / samples; ++py)
        for (int px = 0; px < layer.width() / samples; ++px) {
            Colour sum;
            float coverage = 0;
            for (int k = 0; k < samples * samples; ++k) {
                const std::size_t s = static_cast<std::size_t>(py * samples + k / samples) * row +
                                      static_cast<std::size_t>(px * samples + k % samples);
                const float c = layer.coverage(s);
                const Colour& colour = layer.colour(s);
                sum = {sum.r + c * colour.r, sum.g + c * colour.g, sum.b + c * colour.b};
                coverage += c;
            }
            if (coverage == 0) continue;
            const Colour mean = {sum.r / coverage, sum.g / coverage, sum.b / coverage};
            blend(x + px, y + py, mean, opacity * coverage / static_cast<float>(samples * samples));
        }
}

void Picture::fill(const Rectangle& where, const Colour& colour) {
    for (int y = where.y; y < where.y + where.height; ++y)
        for (int x = where.x; x < where.x + where.width; ++x) blend(x, y, colour, 1);
}

int Picture::write(const Font& font, const std::string& text, int x, int y, float size, const Colour& colour) {
    const stbtt_fontinfo& info = font.impl_->info;
    const float scale = stbtt_ScaleForPixelHeight(&info, size);
    float pen = static_cast<float>(x);
    std::vector<unsigned char> mask;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const float shift = pen - std::floor(pen);
        int x0 = 0;
        int y0 = 0;
        int x1 = 0;
        int y1 = 0;
        stbtt_GetCodepointBitmapBoxSubpixel(&info, text[i], scale, scale, shift, 0, &x0, &y0, &x1, &y1);
        const int w = x1 - x0;
        const int h = y1 - y0;
        mask.assign(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 0);
        if (!mask.empty())
            stbtt_MakeCodepointBitmapSubpixel(&info, mask.data(), w, h, w, scale, scale, shift, 0, text[i]);
        auto ink = mask.cbegin();
        for (int row = y0; row < y1; ++row)
            for (int column = x0; column < x1; ++column)
                blend(static_cast<int>(pen) + column, y + row, colour, static_cast<float>(*ink++) / 255.0f);
        int advance = 0;
        stbtt_GetCodepointHMetrics(&info, text[i], &advance, nullptr);
        const int kern = i + 1 < text.size() ? stbtt_GetCodepointKernAdvance(&info, text[i], text[i + 1]) : 0;
        pen += scale * static_cast<float>(advance + kern);
    }
    return static_cast<int>(std::ceil(pen));
}

void Picture::save(const std::string& path) const {
    std::vector<unsigned char> bytes;
    bytes.reserve(3 * pixels_.size());
    // 64 steps a channel look the same as 256 and make the file a third shorter.
    const auto byte = [](float c) {
        return static_cast<unsigned char>(std::lround(63 * std::clamp(c, 0.0f, 1.0f)) * 255 / 63);
    };
    for (const Colour& p : pixels_) bytes.insert(bytes.end(), {byte(p.r), byte(p.g), byte(p.b)});
    io::OutputFile file(path);
    std::string png;
    const auto append = [](void* target, void* data, int size) {
        static_cast<std::string*>(target)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
    };
    if (stbi_write_png_to_func(append, &png, width_, height_, 3, bytes.data(), 3 * width_) == 0)
        throw io::OutputError(path + ": out of memory for the picture");
    file.write(png);
    file.commit();
}

}  // namespace clinch::draw
