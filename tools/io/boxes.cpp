#include "tools/io/boxes.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

#include "tools/io/npy.hpp"
#include "tools/io/text.hpp"

namespace clinch::io {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float float_max = std::numeric_limits<float>::max();

/// "min x", "max z": the name of number i of a row.
std::string number_name(std::size_t i) {
    return std::string(i < 3 ? "min " : "max ") + "xyz"[i % 3];
}

template <class Number>
std::string why_not(const std::array<Number, 6>& row) {
    for (std::size_t i = 0; i < 6; ++i) {
        if (!std::isfinite(row[i])) return number_name(i) + " is " + to_text(row[i]) + " and must be finite";
        if (std::abs(row[i]) > Number{float_max})
            return number_name(i) + " is " + to_text(row[i]) + " and must be within float32's range, " +
                   to_text(float_max);
    }
    for (std::size_t i = 0; i < 3; ++i)
        if (row[i] > row[i + 3])
            return number_name(i) + " is " + to_text(row[i]) + " and must be <= " + number_name(i + 3) + ", which is " +
                   to_text(row[i + 3]);
    return {};
}

template <class Number>
std::array<Number, 6> row_at(const void* numbers) {
    std::array<Number, 6> row;
    std::memcpy(row.data(), numbers, sizeof row);
    return row;
}

float round_down(double value) {
    const float nearest = static_cast<float>(value);
    return double{nearest} > value ? std::nextafter(nearest, -infinity) : nearest;
}

float round_up(double value) {
    return -round_down(-value);
}

}  // namespace

std::string why_no_box(const std::array<float, 6>& min_max) {
    return why_not(min_max);
}
std::string why_no_box(const std::array<double, 6>& min_max) {
    return why_not(min_max);
}

Aabb round_outward(const std::array<double, 6>& v) {
    return {{round_down(v[0]), round_down(v[1]), round_down(v[2])}, {round_up(v[3]), round_up(v[4]), round_up(v[5])}};
}

BoxFile read_boxes(const std::string& path) {
    NpyFile file(path, {NpyType::Float32, NpyType::Float64}, 6);
    BoxFile result;
    result.boxes.resize(file.rows());
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    // A row is judged before it is rounded: min = 1 + 1e-12 and max = 1 would become a box.
    const auto reject = [&](std::size_t row, std::string why) {
        result.boxes[row] = {{nan, nan, nan}, {nan, nan, nan}};
        result.rejected.push_back({static_cast<std::uint32_t>(row), std::move(why)});
    };
    if (file.type() == NpyType::Float32) {
        file.read_rows(result.boxes.data());
        for (std::size_t i = 0; i < result.boxes.size(); ++i)
            if (std::string why = why_no_box(row_at<float>(&result.boxes[i])); !why.empty()) reject(i, std::move(why));
        return result;
    }
    const std::vector<double> numbers = file.read<double>();
    for (std::size_t i = 0; i < result.boxes.size(); ++i) {
        const auto row = row_at<double>(numbers.data() + 6 * i);
        if (std::string why = why_no_box(row); !why.empty())
            reject(i, std::move(why));
        else
            result.boxes[i] = round_outward(row);
    }
    return result;
}

}  // namespace clinch::io
