#include "src/broad_phase/pair_events.hpp"

#include <algorithm>
#include <cstring>

#include "src/primitives/host_parallel.hpp"

namespace clinch::detail {
namespace {

constexpr std::size_t pairs_a_part = std::size_t{1} << 16;

struct Difference {
    std::vector<Pair> added, removed;
};

// Lists that are mostly the same are gone through a cache line at a time.
Difference difference(const Pair* old, const Pair* old_end, const Pair* now, const Pair* now_end) {
    constexpr std::ptrdiff_t line = 64 / sizeof(Pair);
    Difference found;
    while (old != old_end && now != now_end) {
        if (old_end - old >= line && now_end - now >= line && std::memcmp(old, now, 64) == 0) {
            old += line;
            now += line;
        } else if (*old == *now) {
            ++old;
            ++now;
        } else if (*old < *now) {
            found.removed.push_back(*old++);
        } else {
            found.added.push_back(*now++);
        }
    }
    found.removed.insert(found.removed.end(), old, old_end);
    found.added.insert(found.added.end(), now, now_end);
    return found;
}

}  // namespace

void PairEvents::update(View<const Pair> now) {
    same_again();
    const std::size_t parts = now.size() / pairs_a_part + 1;
    const Pair* const old = last_.data();
    // Part p is of the pairs from its first on, in both lists, up to the first of part p + 1.
    const auto now_from = [&](std::size_t p) { return now.data() + (p == parts ? now.size() : p * pairs_a_part); };
    const auto old_from = [&](std::size_t p) {
        if (p == 0) return old;
        return p == parts || p * pairs_a_part >= now.size() ? old + last_.size()
                                                            : std::lower_bound(old, old + last_.size(), *now_from(p));
    };
    std::vector<Difference> found(parts);
    parallel_for(parts, parts > 2, [&](std::size_t p) {
        found[p] = difference(old_from(p), old_from(p + 1), now_from(p), now_from(p + 1));
    });
    for (const Difference& part : found) {
        added_.insert(added_.end(), part.added.begin(), part.added.end());
        removed_.insert(removed_.end(), part.removed.begin(), part.removed.end());
    }
    if (!added_.empty() || !removed_.empty()) last_.assign(now.begin(), now.end());
}

}  // namespace clinch::detail
