// Where the pairs of one call go: into a list, to the caller piece by piece, or only into their count.
#pragma once

#include <algorithm>
#include <boost/container/vector.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/view.hpp"
#include "src/device/device.hpp"
#include "src/primitives/pair_keys.hpp"
#include "src/primitives/pair_sort.hpp"

namespace clinch::detail {

/// Pairs in host memory of its own, or in device memory that is mapped: then nothing was copied. Or, for a call that
/// streams or counts, none of them.
class PairList {
public:
    using Taker = std::function<void(View<const Pair>)>;

    void clear() {
        restart();
        counts_only_ = false;
        take_ = nullptr;
        piece_ = unlimited;
        accepted_.reset();
    }
    /// Forgets the pairs; where they go stays as it is.
    void restart() {
        mapping_.release();
        starts_.clear();
        host_.clear();
        size_ = 0;
    }
    /// From here to the next clear(): pairs are counted, not kept.
    void count_only() { counts_only_ = true; }
    bool counts_only() const noexcept { return counts_only_; }
    bool streams() const noexcept { return take_ != nullptr; }
    /// From here to the next clear(): pairs go to `take`, which may throw, at most `piece` at a time.
    void stream_to(const Taker& take, std::size_t piece) {
        take_ = &take;
        piece_ = std::max<std::size_t>(piece, 1);
    }
    /// From here to the next clear(): the whole list, in order, of names (FindCounts::named) may come as keys.
    void accept_keys(const KeyLayout& layout) { accepted_ = layout; }
    /// Null where they may not: then pairs must come.
    const KeyLayout* accepted_keys() const noexcept {
        return accepted_ && !counts_only_ && take_ == nullptr ? &*accepted_ : nullptr;
    }
    /// Pairs an algorithm should hold at once, at most.
    std::size_t piece() const noexcept { return piece_; }

    /// Pairs so far.
    std::uint64_t size() const noexcept { return size_; }
    /// Adds pairs behind those there are.
    void append(const Pair* pairs, std::size_t count) {
        size_ += count;
        if (counts_only_) return;
        if (take_ == nullptr) {
            host_.insert(host_.end(), pairs, pairs + count);
            return;
        }
        for (std::size_t first = 0; first < count; first += piece_)
            (*take_)({pairs + first, std::min(piece_, count - first)});
    }
    void append(const std::vector<Pair>& pairs) { append(pairs.data(), pairs.size()); }
    /// Makes room for `count` pairs behind those there are, for the caller to write; of a list that keeps its pairs.
    Pair* extend(std::size_t count) {
        size_ += count;
        host_.resize(host_.size() + count, boost::container::default_init);
        return host_.data() + (host_.size() - count);
    }
    /// Adds to the count of a list that only counts.
    void add_count(std::uint64_t pairs) { size_ += pairs; }
    /// The whole list is `count` pairs in a mapped buffer that outlives this list's next clear().
    void adopt(Mapping mapping, std::size_t count) {
        if (counts_only_ || take_ != nullptr) {
            append(mapping.as<Pair>(), count);
            return;
        }
        clear();
        mapping_ = std::move(mapping);
        size_ = count;
    }
    /// The whole list is keys of the layout that was asked for, which outlive this list's next clear().
    void adopt(PairSort::Packed packed) {
        restart();
        mapping_ = std::move(packed.keys);
        starts_ = std::move(packed.starts);
        size_ = starts_.back();
    }
    /// Takes the last `count` pairs away again, of a list of the host.
    void drop(std::size_t count) {
        size_ -= count;
        host_.resize(host_.size() - count);
    }
    /// Sorts a list of the host that was put together from sorted runs, which end at `ends`. Pieces of a stream stay
    /// sorted each for itself.
    void merge_runs(std::vector<std::size_t> ends) {
        if (counts_only_ || take_ != nullptr) return;
        const auto at = [&](std::size_t i) { return host_.begin() + static_cast<std::ptrdiff_t>(i); };
        while (ends.size() > 1) {  // neighbours in pairs
            std::vector<std::size_t> merged;
            for (std::size_t r = 0; r < ends.size(); r += 2) {
                const std::size_t first = r == 0 ? 0 : ends[r - 1];
                if (r + 1 < ends.size()) std::inplace_merge(at(first), at(ends[r]), at(ends[r + 1]));
                merged.push_back(ends[std::min(r + 1, ends.size() - 1)]);
            }
            ends = std::move(merged);
        }
    }
    /// The list as keys, where it came so.
    PairKeys keys() const noexcept {
        if (starts_.empty()) return {};
        return {*accepted_, {mapping_.as<std::uint32_t>(), static_cast<std::size_t>(size_)}, starts_};
    }
    /// The list; empty when pairs were streamed or counted, or came as keys.
    View<const Pair> view() const noexcept {
        if (counts_only_ || take_ != nullptr || !starts_.empty()) return {};
        const Pair* mapped = mapping_.as<Pair>();
        return {mapped != nullptr ? mapped : host_.data(), static_cast<std::size_t>(size_)};
    }
    /// Host memory of its own.
    std::size_t host_bytes() const noexcept { return host_.capacity() * sizeof(Pair); }

private:
    static constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max();
    boost::container::vector<Pair> host_;  // grows without being filled first
    Mapping mapping_;
    std::optional<KeyLayout> accepted_;
    std::vector<std::uint32_t> starts_;  // of buckets, where mapping_ is of keys
    std::uint64_t size_ = 0;
    bool counts_only_ = false;
    const Taker* take_ = nullptr;
    std::size_t piece_ = unlimited;
};

}  // namespace clinch::detail
