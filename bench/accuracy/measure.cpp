#include "bench/accuracy/measure.hpp"

#include <algorithm>
#include <cmath>

namespace clinch::accuracy {
namespace {

constexpr int least_device_runs = 5, most_device_runs = 60;
constexpr double device_seconds = 0.6;

struct Group {
    Setting setting;
    std::vector<Sample> samples;
};

std::vector<test::TruePair> pairs_of(const std::vector<Sample>& samples) {
    std::vector<test::TruePair> pairs;
    pairs.reserve(samples.size());
    for (const Sample& s : samples) pairs.push_back(s.pair);
    return pairs;
}

double quantile(std::vector<double>& values, double q) {
    if (values.empty()) return 0;
    const auto at = static_cast<std::ptrdiff_t>(
        std::min(static_cast<double>(values.size() - 1), q * static_cast<double>(values.size())));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[static_cast<std::size_t>(at)];
}

class Tally {
public:
    explicit Tally(bool promises) : promises_(promises) {}

    void add(const Sample& sample, const Found& found) {
        ++figures_.pairs;
        if (!found.measured) {
            if (sample.truth.high < 0) ++figures_.missed;
            return;
        }
        bool numbers = std::isfinite(found.distance) && std::isfinite(found.error);
        for (const double x : found.normal) numbers = numbers && std::isfinite(x);
        if (!numbers) {
            ++figures_.not_numbers;
            return;
        }
        const double error = static_cast<double>(std::fabs(found.distance - sample.truth.low));
        errors_.push_back(error / sample.size);
        // A library may give no direction along with a depth of 0.
        const auto& n = found.normal;
        if (n[0] * n[0] + n[1] * n[1] + n[2] * n[2] > 0.5)
            figures_.regret = std::max(figures_.regret, regret(sample.pair, sample.truth, n) / sample.size);
        if (promises_)
            judge(sample, found, error);
        else if (sample.truth.low > 0)
            ++figures_.invented;
    }
    Figures figures() {
        figures_.worst = errors_.empty() ? 0 : *std::max_element(errors_.begin(), errors_.end());
        figures_.promised_worst =
            promises_made_.empty() ? 0 : *std::max_element(promises_made_.begin(), promises_made_.end());
        figures_.p999 = quantile(errors_, 0.999);
        figures_.median = quantile(errors_, 0.5);
        figures_.promised_p99 = quantile(promises_made_, 0.99);
        figures_.promised_median = quantile(promises_made_, 0.5);
        return figures_;
    }

private:
    void judge(const Sample& sample, const Found& found, double error) {
        promises_made_.push_back(found.error / sample.size);
        const Real most = Real(found.distance) + found.error, least = Real(found.distance) - found.error;
        if (most < sample.truth.low || least > sample.truth.high)
            ++figures_.broken;
        else if (most < sample.truth.high || least > sample.truth.low)
            ++figures_.open;
        else
            figures_.ratio = std::max(figures_.ratio, error / found.error);
    }

    bool promises_;
    Figures figures_;
    std::vector<double> errors_, promises_made_;
};

/// Answers of one candidate, as the groups have pairs; nanoseconds a pair, or 0.
struct Run {
    std::vector<std::vector<Found>> found;
    std::vector<double> ns;
};

Run run_on_host(Candidate& candidate, const std::vector<Group>& groups, double least_seconds) {
    Run run;
    for (const Group& group : groups) {
        candidate.load(pairs_of(group.samples), 1);
        double total = candidate.run(), least = total;
        // What is told of a candidate as a whole is the first group's time.
        const bool first = run.ns.empty() && least_seconds > 0;
        for (int runs = 1; total < (first ? 10 : 1) * least_seconds || runs < (first ? 12 : 3); ++runs) {
            const double seconds = candidate.run();
            total += seconds;
            least = std::min(least, seconds);
        }
        run.found.push_back(candidate.found());
        run.ns.push_back(1e9 * least / static_cast<double>(group.samples.size()));
    }
    return run;
}

// All groups in one call, which tells their errors; the first, many times over, in others, which tell the time.
Run run_on_device(Candidate& candidate, const std::vector<Group>& groups, std::size_t timed) {
    constexpr std::size_t worth_a_device = 256;
    Run run;
    std::vector<test::TruePair> pairs;
    for (const Group& group : groups)
        for (const Sample& s : group.samples) pairs.push_back(s.pair);
    candidate.load(pairs, worth_a_device / pairs.size() + 1);
    candidate.run();
    const std::vector<Found> found = candidate.found();
    auto at = found.begin();
    for (const Group& group : groups) {
        const auto end = at + static_cast<std::ptrdiff_t>(group.samples.size());
        run.found.emplace_back(at, end);
        at = end;
    }
    run.ns.assign(groups.size(), 0);
    const std::vector<test::TruePair> usual = pairs_of(groups[0].samples);
    const std::size_t copies = (timed - 1) / usual.size() + 1;
    candidate.load(usual, copies);
    // The least of many short runs: a device of all cores suffers from whatever else the machine does.
    double least = candidate.run(), total = 0;
    for (int i = 0; i < most_device_runs && (i < least_device_runs || total < device_seconds); ++i) {
        const double seconds = candidate.run();
        total += seconds;
        least = std::min(least, seconds);
    }
    run.ns[0] = 1e9 * least / static_cast<double>(usual.size() * copies);
    return run;
}

// No separation is above the true distance, whoever proposed its direction: where the search alone is unsure, those of
// the answers help. One above what the search took for the most contradicts it.
void sharpen(Sample& sample, const Found& found, CellResult& cell) {
    Truth& truth = sample.truth;
    const auto& n = found.normal;
    if (truth.source != Source::search || !(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] > 0.5)) return;
    const Real apart = Difference(sample.pair).apart({n[0], n[1], n[2]});
    if (!(apart > truth.low)) return;
    truth.low = apart;
    if (apart > truth.high + agreement * sample.size && truth.agrees) {
        ++cell.disagreements;
        truth.agrees = false;
    }
    truth.high = std::max(truth.high, apart);
}

CandidateResult sum_up(const Candidate& candidate, const std::vector<Group>& groups, const Run& run) {
    CandidateResult result;
    result.title = candidate.title();
    result.promises = candidate.promises();
    Tally all(result.promises);
    for (std::size_t g = 0; g < groups.size(); ++g) {
        Tally tally(result.promises);
        for (std::size_t i = 0; i < groups[g].samples.size(); ++i) {
            tally.add(groups[g].samples[i], run.found[g][i]);
            all.add(groups[g].samples[i], run.found[g][i]);
        }
        result.settings.push_back({groups[g].setting, tally.figures()});
        result.settings.back().figures.ns = run.ns[g];
    }
    result.usual = result.settings[0].figures;
    result.all = all.figures();
    result.all.ns = result.usual.ns;
    return result;
}

std::vector<Group> groups_of(CellResult& cell, const Options& options) {
    test::Random random(cell.seed);
    std::vector<Group> groups;
    for (const Setting& setting : settings_of(cell.a, cell.b, options.quick)) {
        groups.push_back({setting, {}});
        const std::size_t count =
            setting.axis == "mixture" || setting.axis == "default" ? options.mixture : options.pairs;
        for (std::size_t i = 0; i < count; ++i) {
            groups.back().samples.push_back(sample_of(cell.a, cell.b, lie_of(setting, random), random));
            const Truth& truth = groups.back().samples.back().truth;
            if (!truth.agrees) ++cell.disagreements;
            const std::string source = text_of(truth.source);
            if (std::find(cell.sources.begin(), cell.sources.end(), source) == cell.sources.end())
                cell.sources.push_back(source);
        }
        cell.pairs += count;
    }
    return groups;
}

}  // namespace

CellResult measure_cell(test::Kind a, test::Kind b, const Options& options) {
    CellResult cell;
    cell.a = a;
    cell.b = b;
    cell.seed = 1000 * options.seed + 10 * static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b);
    std::vector<Group> groups = groups_of(cell, options);
    Candidates candidates;
    add_float64(a, b, candidates);
    add_float32(a, b, candidates);
    add_ccd(a, b, candidates);
    if (options.context != nullptr) add_device(*options.context, candidates);
    std::vector<Run> runs;
    for (const auto& candidate : candidates) {
        runs.push_back(candidate->title().where == "device" ? run_on_device(*candidate, groups, options.device_pairs)
                                                            : run_on_host(*candidate, groups, options.least_seconds));
        for (std::size_t g = 0; g < groups.size(); ++g)
            for (std::size_t i = 0; i < groups[g].samples.size(); ++i)
                sharpen(groups[g].samples[i], runs.back().found[g][i], cell);
    }
    for (std::size_t i = 0; i < candidates.size(); ++i)
        cell.candidates.push_back(sum_up(*candidates[i], groups, runs[i]));
    return cell;
}

}  // namespace clinch::accuracy
