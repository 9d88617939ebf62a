#include "tools/io/box_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "tools/io/boxes.hpp"
#include "tools/io/npy.hpp"

namespace clinch::io {
namespace {

constexpr double thinness = 0x1p-60, least_half = 0x1p-100;

/// An interval by its middle and half its width, and how far each end may have moved by that.
struct Interval {
    double middle, half, off;
};

struct Sum {
    double sum, rest;  // sum + rest is exact
};

Sum exact_sum(double a, double b) {  // Knuth's TwoSum
    const double sum = a + b, of_b = sum - a;
    return {sum, (a - (sum - of_b)) + (b - of_b)};
}

Interval interval(double low, double high) {
    const Sum twice_middle = exact_sum(low, high), width = exact_sum(high, -low);
    const double middle = 0.5 * twice_middle.sum, half = 0.5 * width.sum;
    // Halving is exact but for the smallest numbers there are.
    const double lost = std::fabs(twice_middle.sum - 2.0 * middle) + std::fabs(width.sum - 2.0 * half);
    return {middle, half, 0.5 * (std::fabs(twice_middle.rest) + std::fabs(width.rest)) + lost};
}

/// No less than the few numbers that were added up to `sum`, which itself is rounded.
double at_least(double sum) {
    return sum == 0.0 ? 0.0 : std::nextafter(sum * (1.0 + 0x1p-50), std::numeric_limits<double>::max());
}

struct BoxBody {
    Vec3 middle, half;
    double rounded;    // how far rounding may have moved a corner
    double thickened;  // how far a corner was moved to give the box a volume
};

BoxBody box_body(const std::array<double, 6>& v) {
    std::array<Interval, 3> axes{};
    double largest = 0.0, farthest = 0.0, rounded = 0.0, thickened = 0.0;
    for (std::size_t d = 0; d < 3; ++d) {
        axes[d] = interval(v[d], v[d + 3]);
        largest = std::max(largest, axes[d].half);
        farthest = std::max(farthest, std::fabs(axes[d].middle));
        rounded += axes[d].off;  // at least the length of the move
    }
    const double thin = std::max(thinness * (largest > 0.0 ? largest : farthest), least_half);
    for (Interval& axis : axes) {
        if (axis.half > 0.0) continue;
        axis.half = thin;
        thickened += thin;
    }
    return {{axes[0].middle, axes[1].middle, axes[2].middle},
            {axes[0].half, axes[1].half, axes[2].half},
            rounded,
            thickened};
}

void add_row(LoadedScene& loaded, const std::array<double, 6>& row, std::string why_rejected) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const std::size_t index = loaded.scene.row_count();
    Body body;
    if (!why_rejected.empty()) {
        body.shape = loaded.scene.add_shape(Box{});
        body.pose.position = {nan, nan, nan};
        loaded.reasons.push_back({static_cast<std::uint32_t>(index), std::move(why_rejected)});
        loaded.scene.add_body(body);
        return;
    }
    const BoxBody box = box_body(row);
    body.shape = loaded.scene.add_shape(Box{box.half});
    body.pose.position = box.middle;
    body.margin = at_least(box.rounded);
    loaded.scene.add_body(body);
    const double slack = at_least(box.rounded + box.thickened);
    if (slack == 0.0) return;
    loaded.slack.resize(loaded.names.size(), 0.0);
    loaded.slack[index] = slack;
}

template <class Number>
LoadedScene read_rows(NpyFile& file) {
    std::vector<std::array<Number, 6>> rows(file.rows());
    file.read_rows(rows.data());
    LoadedScene loaded;
    loaded.names.resize(rows.size());
    for (const std::array<Number, 6>& row : rows) {
        std::array<double, 6> numbers{};
        std::copy(row.begin(), row.end(), numbers.begin());
        add_row(loaded, numbers, why_no_box(row));
    }
    return loaded;
}

}  // namespace

LoadedScene read_box_scene(const std::string& path) {
    NpyFile file(path, {NpyType::Float32, NpyType::Float64}, 6);
    return file.type() == NpyType::Float32 ? read_rows<float>(file) : read_rows<double>(file);
}

}  // namespace clinch::io
