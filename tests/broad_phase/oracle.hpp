// Pairs of boxes found in two slow, obvious ways that share no code with the library.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/broad_phase.hpp"

namespace clinch::test {

inline bool is_box(const Aabb& b) {
    bool ok = true;
    for (int d = 0; d < 3; ++d) ok = ok && std::isfinite(b.min[d]) && std::isfinite(b.max[d]) && b.min[d] <= b.max[d];
    return ok;
}

// Apart on some axis, or not boxes at all.
inline bool apart(const Aabb& p, const Aabb& q) {
    for (int d = 0; d < 3; ++d)
        if (p.max[d] < q.min[d] || q.max[d] < p.min[d]) return true;
    return !is_box(p) || !is_box(q);
}

inline bool passes(const FilterColumns& f, std::size_t a, std::size_t b) {
    const auto moves = [&](std::size_t i) {
        return f.motion == nullptr || (f.motion[i] != Motion::Static && f.motion[i] != Motion::Sleeping);
    };
    const auto group = [&](std::size_t i) { return f.group == nullptr ? 1u : f.group[i]; };
    const auto mask = [&](std::size_t i) { return f.mask == nullptr ? 0xffffffffu : f.mask[i]; };
    return (group(a) & mask(b)) != 0 && (group(b) & mask(a)) != 0 && (moves(a) || moves(b));
}

/// Every pair looked at. For some thousands of boxes.
inline std::vector<Pair> pairs_by_hand(const std::vector<Aabb>& boxes, const FilterColumns& filters = {}) {
    std::vector<Pair> pairs;
    for (std::uint32_t a = 0; a < boxes.size(); ++a)
        for (std::uint32_t b = a + 1; b < boxes.size(); ++b)
            if (!apart(boxes[a], boxes[b]) && passes(filters, a, b)) pairs.push_back({a, b});
    return pairs;
}

/// Sorted on x, each box against those that begin before it ends. For many boxes.
inline std::vector<Pair> pairs_by_sweep(const std::vector<Aabb>& boxes, const FilterColumns& filters = {}) {
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 0; i < boxes.size(); ++i)
        if (is_box(boxes[i])) order.push_back(i);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t p, std::uint32_t q) { return boxes[p].min[0] < boxes[q].min[0]; });
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < order.size(); ++i)
        for (std::size_t j = i + 1; j < order.size() && boxes[order[j]].min[0] <= boxes[order[i]].max[0]; ++j)
            if (!apart(boxes[order[i]], boxes[order[j]]) && passes(filters, order[i], order[j]))
                pairs.push_back({std::min(order[i], order[j]), std::max(order[i], order[j])});
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

}  // namespace clinch::test
