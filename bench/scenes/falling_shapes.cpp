#include "bench/scenes/falling_shapes.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

namespace clinch::scenes {
namespace {

using Point = std::pair<int, int>;

// The outer contour of each letter, counterclockwise: a corner is two digits, x and y, in tenths of the unit.
constexpr std::array<std::string_view, letter_count> contours{
    "0020325260805939",                          // A
    "005071746576785909",                        // B
    "20507253423223263747567759290702",          // C
    "004073764909",                              // D
    "006062222454552527676909",                  // E
    "00202454552527676909",                      // F
    "2050727545445453423223263747567759290702",  // G
    "002024545070795955252909",                  // H
    "00202909",                                  // I
    "20406269494332230302",                      // J
    "0020235080457959262909",                    // K
    "006062222909",                              // L
    "0020254252757090997955452909",              // M
    "00202560808969642909",                      // N
    "2050727759290702",                          // O
    "0020245475785909",                          // P
    "2040516080727759290702",                    // Q
    "00202350705475785909",                      // R
    "105061645526276768591908051443420201",      // S
    "3050578789090737",                          // T
    "205072795953423223290902",                  // U
    "30508969432909",                            // V
    "1030445460809979755747252909",              // W
    "002043608055795947391935",                  // X
    "305054896946290934",                        // Y
    "00505222575909073702",                      // Z
};

// Twice the area of the triangle, positive when counterclockwise.
int turn(const Point& a, const Point& b, const Point& c) {
    return (b.first - a.first) * (c.second - a.second) - (b.second - a.second) * (c.first - a.first);
}

// The corners of the convex hull, counterclockwise (Andrew's monotone chain); in whole numbers, so without doubt.
std::vector<Point> hull_of(std::vector<Point> points) {
    std::sort(points.begin(), points.end());
    std::vector<Point> hull;
    const auto chain = [&hull](auto first, auto last) {
        const std::size_t start = hull.size();
        for (; first != last; ++first) {
            while (hull.size() >= start + 2 && turn(hull[hull.size() - 2], hull.back(), *first) <= 0) hull.pop_back();
            hull.push_back(*first);
        }
        hull.pop_back();
    };
    chain(points.begin(), points.end());
    chain(points.rbegin(), points.rend());
    return hull;
}

}  // namespace

Hull letter_hull(std::size_t letter) {
    const std::string_view digits = contours.at(letter);
    std::vector<Point> points;
    for (std::size_t i = 0; i + 1 < digits.size(); i += 2) points.emplace_back(digits[i] - '0', digits[i + 1] - '0');
    const std::vector<Point> corners = hull_of(points);
    int width = 0;
    for (const Point& corner : corners) width = std::max(width, corner.first);
    Hull hull;
    for (const double z : {-0.1, 0.1})
        for (const auto& [x, y] : corners) hull.points.push_back({(2 * x - width) / 20.0, (2 * y - 9) / 20.0, z});
    return hull;
}

// Thousandths throughout: rings are multiples of one 16-gon, so that four points of two rings lie in one plane.
Hull torus_hull() {
    constexpr std::array<Point, 5> rings{{{450, -200}, {591, -141}, {650, 0}, {591, 141}, {450, 200}}};
    constexpr std::array<Point, 4> quarter{{{1000, 0}, {924, 383}, {707, 707}, {383, 924}}};
    Hull hull;
    for (const auto& [radius, z] : rings)
        for (std::size_t i = 0; i < 16; ++i) {
            auto [x, y] = quarter[i % 4];
            for (std::size_t quarters = 0; quarters < i / 4; ++quarters) std::tie(x, y) = std::pair(-y, x);
            hull.points.push_back({radius * x / 1e6, radius * y / 1e6, z / 1e3});
        }
    return hull;
}

}  // namespace clinch::scenes
