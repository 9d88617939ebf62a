#include "bench/peers/choice.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <string>

#include "bench/scenes/boxes.hpp"

namespace clinch::peers {
namespace {

constexpr std::uint64_t most_pairs = 100000000;
constexpr std::size_t most_boxes_all_pairs = 10000;
constexpr double allowed_over_own = 1.25;  // auto's time to that of the best of clinch's own algorithms

/// Whether it takes time quadratic in the boxes, or near it.
bool quadratic(const std::string& peer) {
    return peer == "clinch/brute/any" || peer == "clinch/host-brute/any" || peer == "clinch/sweep3/any";
}

/// Peer -> milliseconds a box in the next smaller scene of the kind.
using Tried = std::map<std::string, double>;

std::vector<PeerRow> worth_trying(const std::vector<PeerRow>& rows, std::size_t count, const Tried& tried,
                                  const Rules& rules) {
    std::vector<PeerRow> chosen;
    for (const PeerRow& row : rows) {
        const bool own =
            row.group == Group::Clinch && row.name.size() > 4 && row.name.compare(row.name.size() - 4, 4, "/any") == 0;
        if (!row.make || !(own || row.group == Group::Library)) continue;
        if (quadratic(row.name) && count > most_boxes_all_pairs) continue;
        const auto before = tried.find(row.name);
        if (before != tried.end() && before->second * static_cast<double>(count) > 1000.0 * rules.most_seconds)
            continue;
        chosen.push_back(row);
    }
    return chosen;
}

void remember(const Outcome& outcome, const Rules& rules, Tried& tried) {
    for (const Result& r : outcome.results) {
        const double ms = r.ms.empty() ? 1000.0 * rules.most_seconds : r.median_ms();
        tried[r.row.name] = ms / static_cast<double>(outcome.scene.count);
    }
}

/// The fastest that found all pairs: of clinch's algorithms, `auto` apart, or of the libraries; or null.
const Result* fastest(const Outcome& outcome, Group group) {
    const Result* best = nullptr;
    for (const Result& r : outcome.results) {
        if (r.row.group != group || !r.right || r.ms.empty() || r.row.name == "clinch/auto/any") continue;
        if (best == nullptr || r.median_ms() < best->median_ms()) best = &r;
    }
    return best;
}

/// `clinch/bvh/any` -> `bvh`
std::string short_name(const Result& result) {
    std::string name = result.row.name;
    if (result.row.group != Group::Clinch) return name;
    name.erase(0, name.find('/') + 1);
    return name.substr(0, name.find('/'));
}

/// Prints the row of a scene; returns whether the choice was as good as it should be.
bool print_row(const Outcome& outcome) {
    const auto automatic = std::find_if(outcome.results.begin(), outcome.results.end(),
                                        [](const Result& r) { return r.row.name == "clinch/auto/any"; });
    const Result *const own = fastest(outcome, Group::Clinch), *const library = fastest(outcome, Group::Library);
    std::printf("| `%s` | %zu | %llu |", outcome.scene.kind.c_str(), outcome.scene.count,
                static_cast<unsigned long long>(outcome.pairs));
    bool good = false;
    if (automatic == outcome.results.end() || automatic->ms.empty() || own == nullptr) {
        std::printf(" - | - | - | - | - | no time |\n");
    } else {
        const double ms = automatic->median_ms(), over_own = ms / own->median_ms();
        const double over_library = library == nullptr ? 0.0 : ms / library->median_ms();
        good = over_own <= allowed_over_own && over_library <= 1.0;
        std::printf(" %s %.3f | %s %.3f | %.2f |", automatic->chosen.c_str(), ms, short_name(*own).c_str(),
                    own->median_ms(), over_own);
        if (library == nullptr)
            std::printf(" none within the limit | - |");
        else
            std::printf(" %s %.3f | %.2f |", library->row.name.c_str(), library->median_ms(), over_library);
        std::printf(" %s |\n", good ? "yes" : "NO");
    }
    std::fflush(stdout);
    return good;
}

}  // namespace

void measure_choice(const std::vector<PeerRow>& rows, const ChoiceScenes& scenes, const Rules& rules,
                    const std::function<void(const Outcome&)>& done) {
    std::size_t run = 0, good = 0;
    std::printf(
        "| scene | boxes | pairs | auto, ms | best own, ms | auto / own | best library, ms | auto / library "
        "| as it should be |\n|---|---|---|---|---|---|---|---|---|\n");
    for (const clinch::scenes::BoxKind& kind : clinch::scenes::box_kinds()) {
        const std::vector<std::string>& kinds = scenes.kinds;
        if (!kinds.empty() && std::find(kinds.begin(), kinds.end(), kind.name) == kinds.end()) continue;
        Tried tried;
        for (const std::size_t count : scenes.counts) {
            if (kind.all_pairs && std::uint64_t{count} * (count - 1) / 2 > most_pairs) {
                std::printf("| `%s` | %zu | left out: more than 1e8 pairs | | | | | | |\n", kind.name, count);
                continue;
            }
            const Outcome outcome =
                measure({kind.name, count, scenes.seed}, worth_trying(rows, count, tried, rules), rules);
            remember(outcome, rules, tried);
            ++run;
            if (print_row(outcome)) ++good;
            done(outcome);
        }
    }
    std::printf(
        "\n%zu of %zu scenes as they should be: auto at most %.2f times the best own algorithm and no slower "
        "than the best library\n",
        good, run, allowed_over_own);
}

}  // namespace clinch::peers
