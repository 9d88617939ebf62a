// clinch_draw: a picture of the bodies of a mesh file and of the pairs found among them.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "tools/draw/parts.hpp"
#include "tools/draw/picture.hpp"
#include "tools/draw/render.hpp"
#include "tools/io/error.hpp"
#include "tools/io/mesh_file.hpp"

namespace {

using namespace clinch;
using namespace clinch::draw;

constexpr int samples = 3;  // a pixel is samples x samples samples
constexpr Colour grey = {0.80f, 0.81f, 0.83f};
constexpr Colour orange = {0.96f, 0.50f, 0.11f};
constexpr Colour blue = {0.30f, 0.56f, 0.86f};
constexpr Colour dark_orange = {0.80f, 0.34f, 0.02f};
constexpr Colour dark_blue = {0.10f, 0.32f, 0.62f};
constexpr Colour ink = {0.16f, 0.18f, 0.21f};

struct Arguments {
    std::string mesh, pairs, output;
    std::string font = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
    std::optional<std::uint32_t> part;
    int width = 1120;
};

// The part with the most partners, the first of them.
std::uint32_t busiest(const std::vector<Pair>& pairs, std::size_t count) {
    std::vector<std::size_t> number(count, 0);
    for (const Pair& pair : pairs) {
        ++number[pair.a];
        ++number[pair.b];
    }
    return static_cast<std::uint32_t>(std::max_element(number.begin(), number.end()) - number.begin());
}

// The whole assembly, with the chosen part marked.
Layer draw_assembly(const std::vector<Part>& parts, std::uint32_t chosen, const Camera& camera) {
    Layer layer(camera);
    for (std::uint32_t i = 0; i < parts.size(); ++i)
        layer.draw(parts[i], camera, i == chosen ? orange : grey, static_cast<std::int32_t>(i));
    layer.darken_corners(8 * samples);
    layer.outline(1, 0.55f);
    return layer;
}

// The parts around, which are laid faintly over the picture.
Layer draw_others(const std::vector<Part>& parts, const std::vector<std::uint32_t>& shown, const Camera& camera) {
    Layer layer(camera);
    for (std::uint32_t i = 0; i < parts.size(); ++i)
        if (std::find(shown.begin(), shown.end(), i) == shown.end())
            layer.draw(parts[i], camera, grey, static_cast<std::int32_t>(i));
    layer.outline(1, 0.7f);
    return layer;
}

// The chosen part, its partners, and the boxes of all of them.
Layer draw_partners(const std::vector<Part>& parts, std::uint32_t chosen, const std::vector<std::uint32_t>& found,
                    const Camera& camera) {
    Layer layer(camera);
    layer.draw(parts[chosen], camera, orange, static_cast<std::int32_t>(chosen));
    for (const std::uint32_t i : found) layer.draw(parts[i], camera, blue, static_cast<std::int32_t>(i));
    layer.darken_corners(8 * samples);
    layer.outline(1, 0.55f);
    for (const std::uint32_t i : found) layer.draw_box(parts[i], camera, dark_blue, 0.8 * samples);
    layer.draw_box(parts[chosen], camera, dark_orange, 1.4 * samples);
    return layer;
}

void write_captions(Picture& picture, const Font& font, const std::vector<Part>& parts, const std::vector<Pair>& pairs,
                    std::uint32_t chosen, std::size_t found, int side) {
    const float size = static_cast<float>(picture.width()) / 58.0f;
    const int line = static_cast<int>(size * 1.35f);
    const int first = picture.height() - line - line / 2;
    const int left = picture.width() / 40;
    picture.write(
        font, std::to_string(parts.size()) + " parts, " + std::to_string(pairs.size()) + " pairs of overlapping boxes",
        left, first, size, ink);
    const int right = side + left;
    const int mark = static_cast<int>(size * 0.62f);
    const auto legend = [&](int x, const Colour& colour, const std::string& text) {
        picture.fill({x, first - mark, mark, mark}, colour);
        return picture.write(font, text, x + mark + mark / 2, first, size, ink) + 2 * mark;
    };
    const int x = legend(right, orange, "part " + std::to_string(chosen));
    legend(x, blue, "the " + std::to_string(found) + " parts whose boxes overlap its box");
}

void run(const Arguments& arguments) {
    const std::vector<Part> parts = make_parts(io::read_mesh_nodes(arguments.mesh));
    if (parts.empty()) throw io::InputError(arguments.mesh + " holds no part to draw");
    const std::vector<Pair> pairs = read_pairs(arguments.pairs, parts.size());
    const std::uint32_t chosen = arguments.part.value_or(busiest(pairs, parts.size()));
    if (chosen >= parts.size())
        throw io::InputError("--part: found " + std::to_string(chosen) + "; accepted is 0 to " +
                             std::to_string(parts.size() - 1));
    const std::vector<std::uint32_t> found = partners(pairs, chosen);
    const Font font(arguments.font);

    const int side = arguments.width / 2;
    const Camera camera({-0.62, -0.45, -0.64}, {0, 1, 0}, parts, side * samples, side * samples);
    Picture picture(2 * side, camera.height() / samples + side / 12);
    picture.put(draw_assembly(parts, chosen, camera), samples, 0, 0, 1.0f);
    std::vector<std::uint32_t> shown = found;
    shown.push_back(chosen);
    picture.put(draw_others(parts, shown, camera), samples, side, 0, 0.22f);
    picture.put(draw_partners(parts, chosen, found, camera), samples, side, 0, 1.0f);
    write_captions(picture, font, parts, pairs, chosen, found.size(), side);
    picture.save(arguments.output);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        Arguments arguments;
        CLI::App app{"Draws the bodies of a mesh file, and one of them with all it is paired with.", "clinch_draw"};
        app.add_option("mesh", arguments.mesh, "mesh file, as given to clinch pairs")->required();
        app.add_option("pairs", arguments.pairs, "the .csv file that clinch pairs wrote for it")->required();
        app.add_option("-o,--output", arguments.output, "PNG file to write")->required();
        app.add_option("--part", arguments.part, "index of the part to show (default: the one with most pairs)");
        app.add_option("--width", arguments.width, "width in pixels")->check(CLI::Range(200, 8000));
        app.add_option("--font", arguments.font, "TrueType font of the captions")->capture_default_str();
        try {
            app.parse(argc, argv);
        } catch (const CLI::ParseError& error) {
            return app.exit(error) == 0 ? 0 : 2;
        }
        run(arguments);
        return 0;
    } catch (const clinch::io::InputError& error) {
        std::cerr << "clinch_draw: " << error.what() << '\n';
        return 2;
    } catch (const std::exception& error) {
        std::cerr << "clinch_draw: " << error.what() << '\n';
        return 1;
    }
}
