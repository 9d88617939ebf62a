#include "src/broad_phase/slab_merge.hpp"

#include <algorithm>
#include <cstddef>

#include "src/broad_phase/key_merge.hpp"
#include "src/primitives/host_parallel.hpp"

namespace clinch::detail {
namespace {

constexpr std::size_t least_pairs_a_part = std::size_t{1} << 14;

// A run of one slab's list: pairs [at, end). In a list without names boxes have places, counted up from `place` on.
struct Run {
    const Pair* at;
    const Pair* end;
    std::uint32_t place;
};

// Boxes [first, end) as the a of pairs, and where their pairs begin in the result.
struct Part {
    std::uint32_t first, end;
    std::vector<Run> runs;  // of each slab
    std::size_t pairs = 0, place = 0;
};

bool has_several(SlabSpan slabs) {
    return slabs.first != slabs.last;
}

// The rows of lists, that is, the pairs of one a, in the order of boxes.
class SortedMerge {
public:
    SortedMerge(const SlabDeal& deal, const SlabLists& lists) : deal_(deal), lists_(lists) {}

    Part part(std::uint32_t first, std::uint32_t end) const {
        Part part{first, end, {}, 0, 0};
        for (std::size_t s = 0; s < lists_.size(); ++s) {
            const std::uint32_t place = place_of(s, first);
            part.runs.push_back({row_of(s, lists_[s].named ? first : place),
                                 row_of(s, lists_[s].named ? end : place_of(s, end)), place});
        }
        return part;
    }
    // How many pairs a part has.
    std::size_t count(const Part& part) const {
        std::size_t pairs = 0;
        for (std::size_t s = 0; s < part.runs.size(); ++s) {
            pairs += static_cast<std::size_t>(part.runs[s].end - part.runs[s].at);
            if (!lists_[s].in_range) pairs -= count_of_others(s, part);
        }
        return pairs;
    }
    // Writes the pairs of a part.
    void write(const Part& part, Pair* out) const {
        if (lists_.size() == 2 && lists_[0].named && lists_[1].named && part.pairs / 8 < part.end - part.first) {
            write_union(part.runs[0], part.runs[1], out);
            return;
        }
        std::vector<Run> runs = part.runs;
        for (std::uint32_t a = part.first; a < part.end; ++a) {
            const SlabSpan in = deal_.member_of(a);
            out = has_several(in) ? write_common_row(a, in, runs, out) : write_row(a, in.first, runs, out);
        }
    }

private:
    // Pairs of a part in the list of slab s that belong to other slabs: both boxes are members there, too.
    std::size_t count_of_others(std::size_t s, const Part& part) const {
        const std::vector<std::uint32_t>& members = deal_.members(s);
        const Run& run = part.runs[s];
        std::size_t pairs = 0;
        const Pair* row = run.at;
        for (std::uint32_t place = run.place; place < members.size() && members[place] < part.end; ++place) {
            const std::uint32_t a = members[place];
            if (!has_several(deal_.member_of(a))) continue;
            const std::uint32_t key = lists_[s].named ? a : place;
            row = std::lower_bound(row, run.end, key, [](const Pair& pair, std::uint32_t k) { return pair.a < k; });
            for (; row < run.end && row->a == key; ++row) pairs += deal_.owner(a, name_of(s, row->b)) != s ? 1U : 0U;
        }
        return pairs;
    }
    std::uint32_t name_of(std::size_t s, std::uint32_t box) const {
        return lists_[s].named ? box : deal_.members(s)[box];
    }
    std::uint32_t place_of(std::size_t s, std::uint32_t box) const {
        const std::vector<std::uint32_t>& members = deal_.members(s);
        return static_cast<std::uint32_t>(std::lower_bound(members.begin(), members.end(), box) - members.begin());
    }
    const Pair* row_of(std::size_t s, std::uint32_t key) const {
        return std::lower_bound(lists_[s].pairs.begin(), lists_[s].pairs.end(), key,
                                [](const Pair& pair, std::uint32_t k) { return pair.a < k; });
    }
    // The pairs of box a, which one slab alone has.
    Pair* write_row(std::uint32_t a, std::size_t s, std::vector<Run>& runs, Pair* out) const {
        Run& run = runs[s];
        const Pair *at = run.at, *const end = run.end;
        if (lists_[s].named) {
            for (; end - at >= 8 && at[7].a == a; at += 8, out += 8) std::copy(at, at + 8, out);
            for (; at < end && at->a == a; ++at) *out++ = *at;
        } else {
            const std::uint32_t* const members = deal_.members(s).data();
            const std::uint32_t place = run.place++;
            for (; at < end && at->a == place; ++at) *out++ = {a, members[at->b]};
        }
        run.at = at;
        return out;
    }
    // Those of a box that several slabs have.
    Pair* write_common_row(std::uint32_t a, SlabSpan in, std::vector<Run>& runs, Pair* out) const {
        Pair* const row = out;
        for (std::size_t s = in.first; s <= in.last; ++s) {
            Run& run = runs[s];
            const std::uint32_t key = lists_[s].named ? a : run.place++;
            for (; run.at < run.end && run.at->a == key; ++run.at) {
                const std::uint32_t b = name_of(s, run.at->b);
                if (lists_[s].in_range || deal_.owner(a, b) == s) *out++ = {a, b};
            }
        }
        std::sort(row, out, [](const Pair& p, const Pair& q) { return p.b < q.b; });
        return out;
    }
    // Both runs in order; what both have comes once. Without branches: which one is next is a matter of chance.
    static void write_union(const Run& p, const Run& q, Pair* out) {
        const auto key = [](const Pair* pair) { return std::uint64_t{pair->a} << 32 | pair->b; };
        const Pair *i = p.at, *j = q.at;
        while (i < p.end && j < q.end) {
            const std::uint64_t k = key(i), l = key(j);
            *out++ = k <= l ? *i : *j;
            i += k <= l ? 1 : 0;
            j += l <= k ? 1 : 0;
        }
        out = std::copy(i, p.end, out);
        std::copy(j, q.end, out);
    }

    const SlabDeal& deal_;
    const SlabLists& lists_;
};

std::size_t parts_for(std::uint64_t pairs, std::size_t boxes) {
    const std::size_t most = static_cast<std::size_t>(pairs) / least_pairs_a_part + 1;
    return std::max<std::size_t>(1, std::min({most, 16 * host_threads(), boxes}));
}

void merge_sorted(const SlabDeal& deal, const SlabLists& lists, std::uint64_t pairs, PairList& out) {
    const SortedMerge merge(deal, lists);
    std::vector<Part> parts(parts_for(pairs, deal.boxes()));
    parallel_for(parts.size(), parts.size() > 1, [&](std::size_t p) {
        const auto cut = [&](std::size_t i) { return static_cast<std::uint32_t>(deal.boxes() * i / parts.size()); };
        parts[p] = merge.part(cut(p), cut(p + 1));
        parts[p].pairs = merge.count(parts[p]);
    });
    std::size_t total = 0;
    for (Part& part : parts) {
        part.place = total;
        total += part.pairs;
    }
    Pair* const first = out.extend(total);
    parallel_for(parts.size(), parts.size() > 1, [&](std::size_t p) { merge.write(parts[p], first + parts[p].place); });
}

// A stretch of one slab's list, and where its pairs go.
struct Stretch {
    std::size_t slab, first, end, place = 0;
};

template <class Take>
void each_pair(const SlabDeal& deal, const SlabLists& lists, const Stretch& stretch, const Take& take) {
    const std::uint32_t* const members = deal.members(stretch.slab).data();
    const SlabList& list = lists[stretch.slab];
    for (std::size_t i = stretch.first; i < stretch.end; ++i) {
        const Pair pair = list.pairs[i];
        const std::uint32_t a = list.named ? pair.a : members[pair.a], b = list.named ? pair.b : members[pair.b];
        if (list.in_range || deal.owner(a, b) == stretch.slab) take(Pair{a, b});
    }
}

void join_unsorted(const SlabDeal& deal, const SlabLists& lists, PairList& out) {
    std::vector<Stretch> stretches;
    for (std::size_t s = 0; s < lists.size(); ++s)
        for (std::size_t i = 0; i < lists[s].pairs.size(); i += least_pairs_a_part)
            stretches.push_back({s, i, std::min(lists[s].pairs.size(), i + least_pairs_a_part)});
    std::vector<std::size_t> counts(stretches.size(), 0);
    parallel_for(stretches.size(), stretches.size() > 1, [&](std::size_t k) {
        std::size_t count = 0;
        each_pair(deal, lists, stretches[k], [&](Pair) { ++count; });
        counts[k] = count;
    });
    std::size_t total = 0;
    for (std::size_t k = 0; k < stretches.size(); ++k) {
        stretches[k].place = total;
        total += counts[k];
    }
    Pair* const first = out.extend(total);
    parallel_for(stretches.size(), stretches.size() > 1, [&](std::size_t k) {
        Pair* at = first + stretches[k].place;
        each_pair(deal, lists, stretches[k], [&](Pair pair) { *at++ = pair; });
    });
}

// Whether all pairs that there are came as keys of one layout.
bool are_keys(const SlabLists& lists) {
    const KeyLayout* layout = nullptr;
    for (const SlabList& list : lists) {
        if (!list.keys.any() && !list.pairs.empty()) return false;
        if (!list.keys.any()) continue;
        if (layout != nullptr && !(*layout == list.keys.layout)) return false;
        layout = &list.keys.layout;
    }
    return layout != nullptr;
}

}  // namespace

void merge_slabs(const SlabDeal& deal, const SlabLists& lists, bool sorted, PairList& out) {
    if (sorted && are_keys(lists)) {
        std::vector<PairKeys> keys;
        bool disjoint = true;
        for (const SlabList& list : lists) {
            disjoint = disjoint && list.in_range;
            if (list.keys.any()) keys.push_back(list.keys);
        }
        merge_keys(keys, disjoint, out);
        return;
    }
    SlabLists all = lists;
    std::vector<PairList> unpacked(lists.size());
    std::uint64_t pairs = 0;
    for (std::size_t s = 0; s < lists.size(); ++s) {
        if (lists[s].keys.any()) {  // beside those of another kind of device
            merge_keys({lists[s].keys}, true, unpacked[s]);
            all[s].pairs = unpacked[s].view();
        }
        pairs += all[s].pairs.size();
    }
    if (sorted)
        merge_sorted(deal, all, pairs, out);
    else
        join_unsorted(deal, all, out);
}

}  // namespace clinch::detail
