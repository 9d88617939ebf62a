#include "bench/peers/narrow/table.hpp"

#include <cstdio>

#include "bench/peers/common.hpp"

namespace clinch::peers::narrow {
namespace {

using nlohmann::ordered_json;

const char* name_of(Group group) {
    switch (group) {
        case Group::Clinch:
            return "clinch";
        case Group::Yardstick:
            return "yardstick";
        default:
            return "library";
    }
}

unsigned long long number(std::uint64_t n) {
    return n;
}

/// How many times as long as clinch on one core, by the shortest runs; 0 where there is nothing to compare.
double times_clinch(const Outcome& outcome, const Result* other) {
    const Result* const clinch = find(outcome.results, "clinch");
    return clinch != nullptr && other != nullptr ? other->least_ns() / clinch->least_ns() : 0.0;
}

void print_verdict(const Result& r, Question question) {
    const Verdict& v = *r.verdict;
    std::printf(" %7llu %7llu", number(v.missing), number(v.wrong_touching));
    if (question != Question::Touching)
        std::printf(" %7llu %9.1e %7llu %9.1e %7llu %9.1e", number(v.wrong_distance), v.worst_distance,
                    number(v.wrong_normal), v.worst_normal, number(v.wrong_point), v.worst_point);
    std::printf("  %s", r.right() ? "right" : r.right(forgiven) ? "nearly" : "WRONG");
}

void print_row(const Outcome& outcome, const Result& r) {
    std::printf("  %-17s", r.row.name.c_str());
    if (!r.ns.empty()) {
        std::printf("%9.1f %9.1f %4.0f%% %9.1f", r.least_ns(), r.median_ns(), 100.0 * r.spread(), median(r.cpu_ns));
        if (r.routines_ns.empty())
            std::printf("%10s", "");
        else
            std::printf("%10.1f", least(r.routines_ns));
        std::printf("%9.2f", times_clinch(outcome, &r));
    } else if (r.verdict) {
        std::printf("%53s", "");
    }
    if (r.verdict) print_verdict(r, outcome.job.question);
    std::printf("%s%s\n", r.note.empty() ? "" : " ", r.note.c_str());
}

double times(double one, double other) {
    return other > 0.0 ? one / other : 0.0;
}

/// A library, its time, and how many times as long as clinch's call and its routines alone that is.
void print_against(const Result& clinch, const Result* library) {
    if (library == nullptr)
        std::printf(" | %-40s", "none");
    else
        std::printf(" | %-13s %9.1f %8.2f %7.2f", library->row.name.c_str(), library->least_ns(),
                    times(library->least_ns(), clinch.least_ns()),
                    times(library->least_ns(), least(clinch.routines_ns)));
}

ordered_json json_of(const Verdict& v) {
    return {{"missing", v.missing},
            {"wrong_touching", v.wrong_touching},
            {"wrong_distance", v.wrong_distance},
            {"worst_distance", v.worst_distance},
            {"wrong_normal", v.wrong_normal},
            {"worst_normal", v.worst_normal},
            {"wrong_point", v.wrong_point},
            {"worst_point", v.worst_point},
            {"right", v.wrong() == 0}};
}

ordered_json json_of(const Outcome& outcome, const Result& r) {
    ordered_json json{{"name", r.row.name}, {"group", name_of(r.row.group)}, {"one_core", r.row.one_core}};
    if (!r.ns.empty()) {
        json["ns_least"] = r.least_ns();
        json["ns_median"] = r.median_ns();
        json["spread"] = r.spread();
        json["cpu_ns_median"] = median(r.cpu_ns);
        json["times_clinch"] = times_clinch(outcome, &r);
        if (!r.routines_ns.empty()) {
            json["routines_ns_least"] = least(r.routines_ns);
            json["routines_ns_median"] = median(r.routines_ns);
        }
        json["ns"] = r.ns;
        json["peak_bytes"] = r.peak_bytes;
    }
    if (r.verdict) json["verdict"] = json_of(*r.verdict);
    if (!r.note.empty()) json["note"] = r.note;
    return json;
}

}  // namespace

const std::vector<Job>& jobs() {
    static const std::vector<Job> all{
        {"contact", "depth, normal and a point of overlapping bodies", Regime::Overlap, Question::Contact},
        {"distance", "distance and both points of bodies apart", Regime::Gap, Question::Distance},
        {"apart", "yes or no of bodies apart", Regime::Gap, Question::Touching},
        {"overlapping", "yes or no of overlapping bodies", Regime::Overlap, Question::Touching}};
    return all;
}

void print(const Outcome& outcome) {
    std::printf("\n%s, %s: %s, %zu pairs\n  truth: float64 on the host, promised to %.1e of the size",
                outcome.cell.name.c_str(), outcome.job.name.c_str(), outcome.job.what.c_str(), outcome.pairs,
                outcome.truth_error);
    if (outcome.oracle.pairs > 0)
        std::printf("; within %.1e of the oracle on %zu pairs", outcome.oracle.worst, outcome.oracle.pairs);
    std::printf("\n  %-17s%9s %9s %5s %9s%10s%9s %7s %7s", "", "ns/pair", "median", "iqr", "cpu", "routines",
                "x clinch", "missing", "touch");
    if (outcome.job.question != Question::Touching)
        std::printf(" %7s %9s %7s %9s %7s %9s", "dist", "worst", "normal", "worst", "point", "worst");
    std::printf("\n");
    for (const Result& r : outcome.results) print_row(outcome, r);
    std::fflush(stdout);
}

void print_summary(const std::vector<Outcome>& outcomes) {
    std::printf("\nshortest runs, ns a pair, and times of clinch's: the call, the routines alone\n");
    std::printf("%-18s %-11s %9s %9s %9s %8s | %-13s %9s %8s %7s | %-13s %9s %8s %7s %7s\n", "", "", "clinch",
                "routines", "all cores", "routines", "fastest right", "ns", "x call", "x rout.", "fastest", "ns",
                "x call", "x rout.", "wrong");
    for (const Outcome& outcome : outcomes) {
        const Result* const clinch = find(outcome.results, "clinch");
        if (clinch == nullptr) continue;
        const Result* const all = find(outcome.results, "clinch/all-cores");
        const Result* const fastest = fastest_library(outcome.results, false);
        std::printf("%-18s %-11s %9.1f %9.1f %8.2fx %7.2fx", outcome.cell.name.c_str(), outcome.job.name.c_str(),
                    clinch->least_ns(), least(clinch->routines_ns),
                    all == nullptr ? 0.0 : times(clinch->least_ns(), all->least_ns()),
                    all == nullptr ? 0.0 : times(least(clinch->routines_ns), least(all->routines_ns)));
        print_against(*clinch, fastest_library(outcome.results, true));
        print_against(*clinch, fastest);
        if (fastest != nullptr && fastest->verdict) std::printf(" %7llu", number(fastest->verdict->wrong()));
        std::printf("\n");
    }
}

ordered_json json_of(const Outcome& outcome) {
    ordered_json json{{"cell", outcome.cell.name},
                      {"job", outcome.job.name},
                      {"pairs", outcome.pairs},
                      {"truth_error", outcome.truth_error},
                      {"oracle_pairs", outcome.oracle.pairs},
                      {"oracle_worst", outcome.oracle.worst}};
    const Result* const right = fastest_library(outcome.results, true);
    if (right != nullptr) json["fastest_right"] = right->row.name;
    json["peers"] = ordered_json::array();
    for (const Result& r : outcome.results) json["peers"].push_back(json_of(outcome, r));
    return json;
}

}  // namespace clinch::peers::narrow
