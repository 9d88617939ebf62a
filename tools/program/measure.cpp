#include "tools/program/measure.hpp"

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <vector>

namespace clinch::program {
namespace {

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t middle = values.size() / 2;
    return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

/// The median of each of `stages` by itself.
template <class Times>
Times medians(const std::vector<Times>& runs, std::initializer_list<double Times::*> stages) {
    Times result;
    for (double Times::*const stage : stages) {
        std::vector<double> values;
        values.reserve(runs.size());
        for (const Times& run : runs) values.push_back(run.*stage);
        result.*stage = median(values);
    }
    return result;
}

}  // namespace

Measured measure(std::uint64_t repeat, const std::function<StepOutcome(std::uint64_t)>& step) {
    Measured measured;
    std::vector<StageTimes> runs;
    std::vector<NarrowTimes> narrow_runs;
    for (std::uint64_t run = 0; run <= repeat; ++run) {
        measured.last = step(run);
        if (run == 0) measured.first_ms = measured.last.report.ms.total;
        if (run == 0 && repeat > 0) continue;
        runs.push_back(measured.last.report.ms);
        if (measured.last.narrow) narrow_runs.push_back(measured.last.narrow->ms);
    }
    measured.median = medians(runs, {&StageTimes::total, &StageTimes::upload, &StageTimes::bounds, &StageTimes::broad,
                                     &StageTimes::narrow, &StageTimes::download});
    if (!narrow_runs.empty())
        measured.narrow = medians(narrow_runs, {&NarrowTimes::total, &NarrowTimes::upload, &NarrowTimes::buckets,
                                                &NarrowTimes::routines, &NarrowTimes::manifolds, &NarrowTimes::gather});
    return measured;
}

}  // namespace clinch::program
