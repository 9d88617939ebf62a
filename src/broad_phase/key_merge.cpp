#include "src/broad_phase/key_merge.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "src/primitives/host_parallel.hpp"

namespace clinch::detail {
namespace {

// A part's keys and what becomes of them stay in a core's cache.
constexpr std::size_t keys_a_part = std::size_t{1} << 14;
// More than this is not in a cache any more when it is read.
constexpr std::size_t pairs_past_caches = std::size_t{1} << 21;

using Keys = View<const std::uint32_t>;

Keys bucket_of(const PairKeys& list, std::size_t bucket) {
    return {list.keys.data() + list.starts[bucket], list.starts[bucket + 1] - list.starts[bucket]};
}

// Both runs in order; what both have comes once. Returns the end. Where many keys of one run come before all that is
// left of the other, eight at a time; else without branches: which run is next is a matter of chance.
std::uint32_t* write_union(Keys one, Keys other, std::uint32_t* out) {
    constexpr std::ptrdiff_t block = 8;
    const std::uint32_t *p = one.begin(), *q = other.begin(), *const p_end = one.end(), *const q_end = other.end();
    const auto step = [&] {
        const std::uint32_t k = *p, l = *q;
        *out++ = std::min(k, l);
        p += k <= l ? 1 : 0;
        q += l <= k ? 1 : 0;
    };
    while (p_end - p >= block && q_end - q >= block) {
        if (p[block - 1] < *q) {
            out = std::copy(p, p + block, out);
            p += block;
        } else if (q[block - 1] < *p) {
            out = std::copy(q, q + block, out);
            q += block;
        } else {
            for (std::ptrdiff_t i = 0; i < block; ++i) step();
        }
    }
    while (p < p_end && q < q_end) step();
    return std::copy(q, q_end, std::copy(p, p_end, out));
}

// Buckets [first, end).
struct Part {
    std::size_t first, end;
};

// Few buckets of many keys, or many of few.
std::vector<Part> parts_of(const std::vector<PairKeys>& lists) {
    std::vector<Part> parts;
    std::size_t keys = keys_a_part;
    for (std::size_t bucket = 0; bucket + 1 < lists[0].starts.size(); ++bucket) {
        if (keys >= keys_a_part) {
            parts.push_back({bucket, bucket});
            keys = 0;
        }
        parts.back().end = bucket + 1;
        for (const PairKeys& list : lists) keys += bucket_of(list, bucket).size();
    }
    return parts;
}

// The keys of a part, each once, bucket by bucket, and where their pairs begin in the result.
class Merged {
public:
    void make(const std::vector<PairKeys>& lists, const Part& part) {
        std::size_t room = 0;
        for (const PairKeys& list : lists) room += list.starts[part.end] - list.starts[part.first];
        for (std::vector<std::uint32_t>& keys : rooms_) keys.resize(std::max(keys.size(), lists.size() > 1 ? room : 0));
        first_ = part.first;
        buckets_.clear();
        size_ = room = 0;
        for (std::size_t bucket = part.first; bucket < part.end; ++bucket) {
            runs_.clear();
            const std::size_t place = room;
            for (const PairKeys& list : lists) {
                const Keys run = bucket_of(list, bucket);
                room += run.size();
                if (!run.empty()) runs_.push_back(run);
            }
            buckets_.push_back(union_of_runs(place));
            size_ += buckets_.back().size();
        }
    }
    std::size_t size() const noexcept { return size_; }
    void set_place(std::size_t place) noexcept { place_ = place; }

    template <bool past_caches>
    void put(const KeyLayout& layout, Pair* out) const {
        out += place_;
        for (std::size_t i = 0; i < buckets_.size(); ++i) {
            unpack_keys<past_caches>(buckets_[i].data(), buckets_[i].size(), static_cast<std::uint32_t>(first_ + i),
                                     layout, out);
            out += buckets_[i].size();
        }
        if (past_caches) end_past_caches();
    }

private:
    // Neighbours become one, from one room into the other and back, from `place` on; one run stays where it is.
    Keys union_of_runs(std::size_t place) {
        for (std::size_t into = 0; runs_.size() > 1; into = 1 - into) {
            std::uint32_t* at = rooms_[into].data() + place;
            std::size_t made = 0;
            for (std::size_t r = 0; r < runs_.size(); r += 2) {
                std::uint32_t* const end = write_union(runs_[r], r + 1 < runs_.size() ? runs_[r + 1] : Keys(), at);
                runs_[made++] = {at, static_cast<std::size_t>(end - at)};
                at = end;
            }
            runs_.resize(made);
        }
        return runs_.empty() ? Keys() : runs_[0];
    }

    std::vector<std::uint32_t> rooms_[2];
    std::vector<Keys> runs_, buckets_;
    std::size_t first_ = 0, size_ = 0, place_ = 0;
};

template <bool past_caches>
void merge_parts(const std::vector<PairKeys>& lists, std::size_t most, PairList& out) {
    const std::vector<Part> parts = parts_of(lists);
    Pair* const first = out.extend(most);
    std::size_t total = 0;
    parallel_in_order<Merged>(
        parts.size(), [&](std::size_t i, Merged& merged) { merged.make(lists, parts[i]); },
        [&](Merged& merged) {
            merged.set_place(total);
            total += merged.size();
        },
        [&](const Merged& merged) { merged.put<past_caches>(lists[0].layout, first); });
    out.drop(most - total);
}

}  // namespace

void merge_keys(const std::vector<PairKeys>& lists, PairList& out) {
    std::size_t most = 0;
    for (const PairKeys& list : lists) most += list.size();
    if (most == 0) return;
    if (most >= pairs_past_caches)
        merge_parts<true>(lists, most, out);
    else
        merge_parts<false>(lists, most, out);
}

}  // namespace clinch::detail
