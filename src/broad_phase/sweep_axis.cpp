#include "src/broad_phase/sweep_axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace clinch::detail {
namespace {

// What sweep_statistics writes, a run each.
struct Record {
    std::uint32_t boxes;
    float shift[3], sum[3], square[3], low[3], high[3];
};
static_assert(sizeof(Record) == 64, "kernels write this layout");

struct Spread {
    double variance = 0.0, extent = 0.0;
};

// Of all runs together on axis d: the runs' own sums of squares, and those of their means [Chan 1979].
Spread spread_on(const std::vector<Record>& records, std::size_t d) {
    double count = 0.0, sum = 0.0, squares = 0.0;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Record& r : records) {
        if (r.boxes == 0) continue;
        const double n = r.boxes, total = static_cast<double>(r.shift[d]) * n + static_cast<double>(r.sum[d]);
        squares += std::max(0.0, static_cast<double>(r.square[d]) - static_cast<double>(r.sum[d]) * r.sum[d] / n);
        if (count > 0.0) {
            const double between = total / n - sum / count;
            squares += between * between * count * n / (count + n);
        }
        count += n;
        sum += total;
        low = std::min(low, static_cast<double>(r.low[d]));
        high = std::max(high, static_cast<double>(r.high[d]));
    }
    return {squares / std::max(count, 1.0), high - low};
}

}  // namespace

AxisChoice AxisChooser::choose(BoxInput& boxes) {
    if (!kernel_) kernel_ = device_.kernel("broad_phase/sweep", "sweep_statistics");
    const DeviceInfo& info = device_.info();
    const std::uint32_t n = boxes.count();
    const std::uint32_t wanted = std::clamp(n / 1024, 1u, info.compute_units * (info.lanes > 1 ? 4u : 64u));
    const std::uint32_t per_run = std::min(n / wanted + 1, 4096u);  // of more the float sums would be poor
    const std::uint32_t runs = (n - 1) / per_run + 1;
    std::vector<Record> records(runs);
    device_.reserve(records_, records.size() * sizeof(Record), "the statistics of a sweep");
    const std::size_t group = device_.group_size();
    device_.launch(kernel_.args(boxes.on(device_), boxes.first(), n, per_run, runs, records_),
                   (runs + group - 1) / group, group);
    device_.read(records_, records.data(), records.size() * sizeof(Record));

    std::array<Spread, 3> spreads;
    bool finite = true;
    AxisChoice choice;
    for (const Record& record : records) choice.boxes += record.boxes;
    for (std::uint32_t d = 0; d < 3; ++d) {
        spreads[d] = spread_on(records, d);
        finite = finite && std::isfinite(spreads[d].variance);
    }
    const auto less = [&](const Spread& p, const Spread& q) {
        return finite && p.variance != q.variance ? p.variance < q.variance : p.extent < q.extent;
    };
    for (std::uint32_t d = 1; d < 3; ++d)
        if (less(spreads[choice.axis], spreads[d])) choice.axis = d;
    return choice;
}

}  // namespace clinch::detail
