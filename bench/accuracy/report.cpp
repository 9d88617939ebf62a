#include "bench/accuracy/report.hpp"

#include <algorithm>
#include <cstdio>
#include <ostream>

#include "src/narrow_phase/cursor.hpp"

namespace clinch::accuracy {
namespace {

nlohmann::json json_of(const Figures& f) {
    nlohmann::json j = {{"pairs", f.pairs},
                        {"worst", f.worst},
                        {"p99.9", f.p999},
                        {"median", f.median},
                        {"regret", f.regret},
                        {"not_numbers", f.not_numbers},
                        {"missed", f.missed},
                        {"invented", f.invented},
                        {"broken", f.broken},
                        {"open", f.open},
                        {"promised_worst", f.promised_worst},
                        {"promised_p99", f.promised_p99},
                        {"promised_median", f.promised_median},
                        {"error_to_promise", f.ratio}};
    if (f.ns > 0) j["ns"] = f.ns;
    return j;
}

// Nothing of the same place is both faster and at least as exact.
bool on_front(const CellResult& cell, const CandidateResult& candidate) {
    return std::none_of(cell.candidates.begin(), cell.candidates.end(), [&](const CandidateResult& other) {
        return other.title.where == candidate.title.where && other.promises && other.all.ns < candidate.all.ns &&
               other.all.p999 <= candidate.all.p999;
    });
}

const CandidateResult* find(const CellResult& cell, const char* where, unsigned bits) {
    for (const CandidateResult& c : cell.candidates)
        if (c.title.routine == "own" && c.title.where == where && c.title.bits == bits && c.title.tolerance < 0)
            return &c;
    return nullptr;
}

nlohmann::json mark_of(const detail::Measured* m) {
    if (m == nullptr) return nullptr;
    nlohmann::json j = {{"general", m->routine == detail::Routine::general || m->tolerance >= 0.0f}, {"bits", m->bits}};
    if (m->tolerance >= 0.0f) j["tolerance"] = m->tolerance;
    return j;
}

// What the cursor takes at several precisions and tolerances (relative to the pair's size), by the table in use.
nlohmann::json choices_of(const CellResult& cell) {
    const std::size_t at = 8 * static_cast<std::size_t>(cell.a) + static_cast<std::size_t>(cell.b);
    const detail::MatrixRow& row = detail::matrix()[detail::bucket_table()[at]];
    nlohmann::json all = nlohmann::json::array();
    const auto add = [&](const char* what, double value, const NarrowPhaseOptions& options) {
        const detail::Plan plan = detail::plan_of(row, options, 1.0);
        static const char* const names[] = {"float32", "float32 then float64", "float64"};
        all.push_back({{what, value},
                       {"passes", names[static_cast<std::size_t>(plan.passes)]},
                       {"routine", plan.routine == detail::Routine::own ? "own" : "gjk-epa"},
                       {"float32", mark_of(plan.row32)},
                       {"float64", mark_of(plan.row64)}});
    };
    for (const double precision : {0.0, 0.5, 1.0}) {
        NarrowPhaseOptions options;
        options.precision = precision;
        add("precision", precision, options);
    }
    for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10, 1e-12}) {
        NarrowPhaseOptions options;
        options.tolerance = tolerance;
        add("tolerance", tolerance, options);
    }
    return all;
}

std::string in_digits(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1e", x);
    return text;
}

std::string text_of_ns(const CandidateResult* c) {
    if (c == nullptr) return "-";
    char text[32];
    std::snprintf(text, sizeof text, "%.0f", c->all.ns);
    return text;
}

std::string text_of_worst(const CandidateResult* c) {
    return c == nullptr ? "-" : in_digits(c->all.worst);
}

}  // namespace

std::string text_of(const Title& title) {
    std::string text = title.routine + " float" + std::to_string(title.bits) + " " + title.where;
    if (title.tolerance >= 0) text += " to " + in_digits(title.tolerance);
    return text;
}

std::string classes_of(const CellResult& cell) {
    const std::size_t at = 8 * static_cast<std::size_t>(cell.a) + static_cast<std::size_t>(cell.b);
    return detail::classes_text(detail::matrix()[detail::bucket_table()[at]]);
}

nlohmann::json json_of(const std::vector<CellResult>& cells, const Options& options, const std::string& device) {
    nlohmann::json all = {{"seed", options.seed}, {"quick", options.quick}, {"device", device}};
    all["cells"] = nlohmann::json::array();
    for (const CellResult& cell : cells) {
        nlohmann::json j = {{"classes", classes_of(cell)},
                            {"seed", cell.seed},
                            {"pairs", cell.pairs},
                            {"references", cell.sources},
                            {"references_disagree", cell.disagreements},
                            {"choices", choices_of(cell)},
                            {"candidates", nlohmann::json::array()}};
        for (const CandidateResult& candidate : cell.candidates) {
            nlohmann::json c = {{"name", text_of(candidate.title)}, {"routine", candidate.title.routine},
                                {"where", candidate.title.where},   {"bits", candidate.title.bits},
                                {"promises", candidate.promises},   {"front", on_front(cell, candidate)},
                                {"all", json_of(candidate.all)},    {"settings", nlohmann::json::array()}};
            if (candidate.title.tolerance >= 0) c["tolerance"] = candidate.title.tolerance;
            for (const SettingFigures& s : candidate.settings) {
                nlohmann::json figures = json_of(s.figures);
                figures["axis"] = s.setting.axis;
                figures["value"] = s.setting.value;
                c["settings"].push_back(std::move(figures));
            }
            j["candidates"].push_back(std::move(c));
        }
        all["cells"].push_back(std::move(j));
    }
    return all;
}

void write_summary(const std::vector<CellResult>& cells, std::ostream& out) {
    out << "| classes | pairs | device float32: ns | worst error | device float64: ns | worst error | host float64: ns "
           "| worst error | worst error to promise | broken | open |\n|---|---|---|---|---|---|---|---|---|---|---|\n";
    for (const CellResult& cell : cells) {
        const CandidateResult *f = find(cell, "device", 32), *d = find(cell, "device", 64), *h = find(cell, "host", 64);
        double ratio = 0;
        std::size_t broken = 0, open = 0;
        for (const CandidateResult& c : cell.candidates) {
            ratio = std::max(ratio, c.all.ratio);
            broken += c.all.broken;
            open += c.all.open;
        }
        char ratio_text[32];
        std::snprintf(ratio_text, sizeof ratio_text, "%.2f", ratio);
        out << "| " << classes_of(cell) << " | " << cell.pairs << " | " << text_of_ns(f) << " | " << text_of_worst(f)
            << " | " << text_of_ns(d) << " | " << text_of_worst(d) << " | " << text_of_ns(h) << " | "
            << text_of_worst(h) << " | " << ratio_text << " | " << broken << " | " << open << " |\n";
    }
}

std::size_t faults(const std::vector<CellResult>& cells) {
    std::size_t count = 0;
    for (const CellResult& cell : cells) {
        count += cell.disagreements;
        for (const CandidateResult& c : cell.candidates)
            if (c.promises) count += c.all.broken + c.all.not_numbers;
    }
    return count;
}

}  // namespace clinch::accuracy
