#include "src/broad_phase/key_merge.hpp"

#include <algorithm>
#include <array>
#include <boost/container/vector.hpp>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "src/primitives/host_parallel.hpp"

namespace clinch::detail {
namespace {

// A part's keys and what becomes of them stay in a core's cache.
constexpr std::size_t keys_a_part = std::size_t{1} << 14;
// Room for more than this is in no core's cache any more since it was last read: pairs written past the caches, a
// million take 0.3 ms less (measured), and one who reads them 0.1 ms more.
constexpr std::size_t pairs_past_caches = std::size_t{1} << 19;

using Keys = View<const std::uint32_t>;

Keys bucket_of(const PairKeys& list, std::size_t bucket) {
    return {list.keys.data() + list.starts[bucket], list.starts[bucket + 1] - list.starts[bucket]};
}

// Two runs on their way into one at `out`, in order; what both have comes once.
struct Lane {
    const std::uint32_t *p, *p_end, *q, *q_end;
    std::uint32_t* out;
    // So many keys can be written before a run may end.
    std::ptrdiff_t sure_steps() const noexcept { return std::min(p_end - p, q_end - q); }
};

constexpr std::ptrdiff_t block = 8;

// Eight keys at a time, `most` times or until a run is near its end; returns how often one run alone had them. By
// comparisons, of which compilers make jumps: where it has, runs change seldom.
std::size_t write_blocks(Lane& lane, std::size_t most) {
    const std::uint32_t *p = lane.p, *q = lane.q, *const p_end = lane.p_end, *const q_end = lane.q_end;
    std::uint32_t* out = lane.out;
    std::size_t mixed = 0, all = 0;
    for (; all < most && p_end - p >= block && q_end - q >= block; ++all) {
        if (p[block - 1] < *q) {
            out = std::copy(p, p + block, out);
            p += block;
        } else if (q[block - 1] < *p) {
            out = std::copy(q, q + block, out);
            q += block;
        } else {
            ++mixed;
            for (std::ptrdiff_t i = 0; i < block; ++i) {
                const std::uint32_t k = *p, l = *q;
                *out++ = std::min(k, l);
                p += k <= l ? 1 : 0;
                q += l <= k ? 1 : 0;
            }
        }
    }
    lane = {p, p_end, q, q_end, out};
    return all - mixed;
}

// The next key of both runs, neither of them at its end. By arithmetic alone: where it is a matter of chance which run
// has it, a jump is often foreseen wrong.
std::uint32_t take_next(const std::uint32_t*& p, const std::uint32_t*& q) noexcept {
    const std::uint64_t k = *p, l = *q, k_is_less = (k - l) >> 63, l_is_less = (l - k) >> 63;
    p += 1 - l_is_less;
    q += 1 - k_is_less;
    return static_cast<std::uint32_t>(l + ((k - l) & (0 - k_is_less)));
}

// All that is left of a lane; returns the end.
std::uint32_t* write_rest(Lane lane) {
    write_blocks(lane, std::numeric_limits<std::size_t>::max());
    while (lane.sure_steps() > 0) *lane.out++ = take_next(lane.p, lane.q);
    return std::copy(lane.q, lane.q_end, std::copy(lane.p, lane.p_end, lane.out));
}

constexpr std::size_t looks = 8, least_blocks = 3;  // of one run alone, of those first looked at

// Whether keys of one run come many in a row, as where a box has all its pairs from one slab.
bool come_in_blocks(Keys one, Keys other) {
    std::uint32_t seen[looks * block];
    Lane lane{one.begin(), one.end(), other.begin(), other.end(), seen};
    return write_blocks(lane, looks) >= least_blocks;
}

// Each key waits for those that were read for the one before; hence four lanes at a time: 0.9 ns a key in place of 2.6
// (measured).
constexpr std::size_t lane_count = 4;
using Lanes = std::array<Lane, lane_count>;

// Pieces of both runs, each with room for all its keys. Equal keys are in the same one.
Lanes cut(const Lane& whole) {
    Lanes lanes;
    Lane left = whole;
    if (left.p_end - left.p < left.q_end - left.q) {
        std::swap(left.p, left.q);
        std::swap(left.p_end, left.q_end);
    }
    for (std::size_t i = 0; i + 1 < lane_count; ++i) {
        const std::uint32_t* const p = left.p + (left.p_end - left.p) / static_cast<std::ptrdiff_t>(lane_count - i);
        const std::uint32_t* const q = std::lower_bound(left.q, left.q_end, *p);
        lanes[i] = {left.p, p, left.q, q, left.out};
        left = {p, left.p_end, q, left.q_end, left.out + (p - left.p) + (q - left.q)};
    }
    lanes.back() = left;
    return lanes;
}

// All lanes in step until one is near its end.
void advance(Lanes& lanes) noexcept {
    for (;;) {
        std::ptrdiff_t steps = lanes[0].sure_steps();
        for (const Lane& lane : lanes) steps = std::min(steps, lane.sure_steps());
        if (steps < block) return;
        auto [a, b, c, d] = lanes;  // what nobody else sees can stay in registers
        for (std::ptrdiff_t i = 0; i < steps; ++i) {
            a.out[i] = take_next(a.p, a.q);
            b.out[i] = take_next(b.p, b.q);
            c.out[i] = take_next(c.p, c.q);
            d.out[i] = take_next(d.p, d.q);
        }
        lanes = {a, b, c, d};
        for (Lane& lane : lanes) lane.out += steps;
    }
}

// Both runs in order; what both have comes once. Returns the end; there must be room for both.
std::uint32_t* write_union(Keys one, Keys other, std::uint32_t* out) {
    constexpr std::ptrdiff_t least_keys = 256;  // of a run, from which on lanes pay (measured)
    Lane whole{one.begin(), one.end(), other.begin(), other.end(), out};
    if (whole.sure_steps() < least_keys || come_in_blocks(one, other)) return write_rest(whole);
    Lanes lanes = cut(whole);
    const Lanes begins = lanes;
    advance(lanes);
    std::uint32_t* end = whole.out;
    for (std::size_t i = 0; i < lane_count; ++i) {  // what came twice leaves gaps
        std::uint32_t *const begin = begins[i].out, *const lane_end = write_rest(lanes[i]);
        end = end == begin ? lane_end : std::copy(begin, lane_end, end);
    }
    return end;
}

// The pairs of both runs, which have no key in common, in order.
template <bool past_caches>
void write_pairs(Keys one, Keys other, const KeyUnpacker<past_caches>& unpack, Pair* out) {
    const std::uint32_t *p = one.begin(), *q = other.begin(), *const p_end = one.end(), *const q_end = other.end();
    if (unpack.before_fours(out) != 0) unpack.one(*p < *q ? *p++ : *q++, out++);
    std::uint32_t mixed[block];
    for (; p_end - p >= block && q_end - q >= block; out += block) {
        const std::uint32_t* next = mixed;
        if (p[block - 1] < *q) {
            next = p;
            p += block;
        } else if (q[block - 1] < *p) {
            next = q;
            q += block;
        } else {
            for (std::ptrdiff_t i = 0; i < block; ++i) mixed[i] = take_next(p, q);
        }
        unpack.four(next, out);
        unpack.four(next + 4, out + 4);
    }
    // A run is near its end: not more than `block` keys of it, perhaps after many of the other.
    while (p < p_end && q < q_end) unpack.one(take_next(p, q), out++);
    unpack.all(p, static_cast<std::size_t>(p_end - p), out);
    unpack.all(q, static_cast<std::size_t>(q_end - q), out + (p_end - p));
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
    void make(const std::vector<PairKeys>& lists, bool disjoint, const Part& part) {
        std::size_t room = 0;
        for (const PairKeys& list : lists) room += list.starts[part.end] - list.starts[part.first];
        const std::size_t rooms = lists.size() > 2 ? 2 : lists.size() > 1 ? 1 : 0;
        for (std::size_t k = 0; k < rooms; ++k)
            if (rooms_[k].size() < room) rooms_[k] = Room(room, boost::container::default_init);
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
            const bool later = disjoint && runs_.size() == 2 && come_in_blocks(runs_[0], runs_[1]);
            buckets_.push_back(later ? Bucket{runs_[0], runs_[1]} : Bucket{union_of_runs(place), {}});
            size_ += buckets_.back().size();
        }
    }
    std::size_t size() const noexcept { return size_; }
    void set_place(std::size_t place) noexcept { place_ = place; }

    template <bool past_caches>
    void put(const KeyLayout& layout, Pair* out) const {
        out += place_;
        for (std::size_t i = 0; i < buckets_.size(); ++i) {
            const Bucket& bucket = buckets_[i];
            const KeyUnpacker<past_caches> unpack(static_cast<std::uint32_t>(first_ + i), layout);
            if (bucket.other.empty())
                unpack.all(bucket.one.data(), bucket.one.size(), out);
            else
                write_pairs(bucket.one, bucket.other, unpack, out);
            out += bucket.size();
        }
        if (past_caches) end_past_caches();
    }

private:
    // Of one run, or of two that have no key in common and become one on the way out.
    struct Bucket {
        Keys one, other;
        std::size_t size() const noexcept { return one.size() + other.size(); }
    };

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

    using Room = boost::container::vector<std::uint32_t>;  // is not filled first
    Room rooms_[2];
    std::vector<Keys> runs_;
    std::vector<Bucket> buckets_;
    std::size_t first_ = 0, size_ = 0, place_ = 0;
};

template <bool past_caches>
void merge_parts(const std::vector<PairKeys>& lists, bool disjoint, std::size_t most, PairList& out) {
    const std::vector<Part> parts = parts_of(lists);
    Pair* const first = out.extend(most);
    std::size_t total = 0;
    parallel_in_order<Merged>(
        parts.size(), [&](std::size_t i, Merged& merged) { merged.make(lists, disjoint, parts[i]); },
        [&](Merged& merged) {
            merged.set_place(total);
            total += merged.size();
        },
        [&](const Merged& merged) { merged.put<past_caches>(lists[0].layout, first); });
    out.drop(most - total);
}

}  // namespace

void merge_keys(const std::vector<PairKeys>& lists, bool disjoint, PairList& out) {
    std::size_t most = 0;
    for (const PairKeys& list : lists) most += list.size();
    if (most == 0) return;
    if (most >= pairs_past_caches)
        merge_parts<true>(lists, disjoint, most, out);
    else
        merge_parts<false>(lists, disjoint, most, out);
}

}  // namespace clinch::detail
