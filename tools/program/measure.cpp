#include "tools/program/measure.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace clinch::program {
namespace {

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t middle = values.size() / 2;
    return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

StageTimes medians(const std::vector<StageTimes>& runs) {
    const auto of = [&](double StageTimes::*stage) {
        std::vector<double> values;
        values.reserve(runs.size());
        for (const StageTimes& run : runs) values.push_back(run.*stage);
        return median(values);
    };
    StageTimes result;
    for (const auto stage :
         {&StageTimes::total, &StageTimes::upload, &StageTimes::bounds, &StageTimes::broad, &StageTimes::download})
        result.*stage = of(stage);
    return result;
}

}  // namespace

Measured measure(std::uint64_t repeat, const std::function<StepOutcome(std::uint64_t)>& step) {
    Measured measured;
    std::vector<StageTimes> runs;
    for (std::uint64_t run = 0; run <= repeat; ++run) {
        measured.last = step(run);
        if (run == 0) measured.first_ms = measured.last.report.ms.total;
        if (run > 0 || repeat == 0) runs.push_back(measured.last.report.ms);
    }
    measured.median = medians(runs);
    return measured;
}

}  // namespace clinch::program
