// The pairs of one call, readable on the host.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/view.hpp"
#include "src/device/device.hpp"

namespace clinch::detail {

/// Pairs in host memory of its own, or in device memory that is mapped: then nothing was copied.
class PairList {
public:
    void clear() {
        mapping_.release();
        host_.clear();
        size_ = 0;
    }
    /// Adds pairs behind those there are.
    void append(const Pair* pairs, std::size_t count) {
        host_.insert(host_.end(), pairs, pairs + count);
        size_ = host_.size();
    }
    void append(const std::vector<Pair>& pairs) { append(pairs.data(), pairs.size()); }
    /// The whole list is `count` pairs in a mapped buffer that outlives this list's next clear().
    void adopt(Mapping mapping, std::size_t count) {
        clear();
        mapping_ = std::move(mapping);
        size_ = count;
    }
    /// Sorts a list of the host that was put together from sorted runs, which end at `ends`.
    void merge_runs(std::vector<std::size_t> ends) {
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
    View<const Pair> view() const noexcept {
        const Pair* mapped = mapping_.as<Pair>();
        return {mapped != nullptr ? mapped : host_.data(), size_};
    }

private:
    std::vector<Pair> host_;
    Mapping mapping_;
    std::size_t size_ = 0;
};

}  // namespace clinch::detail
