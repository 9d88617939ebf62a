#include "clinch/warm_start.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "src/narrow_phase/warm_start_impl.hpp"
#include "src/primitives/host_parallel.hpp"

namespace clinch {
namespace {

constexpr std::size_t pairs_a_part = 8192;

bool before(const Pair& p, const Pair& q) {
    return p.a != q.a ? p.a < q.a : p.b < q.b;
}

}  // namespace

void WarmStart::Impl::sort_old() {
    order_.clear();
    if (std::is_sorted(old_pairs_.begin(), old_pairs_.end(), before)) return;
    order_.resize(old_pairs_.size());
    std::iota(order_.begin(), order_.end(), 0u);
    std::sort(order_.begin(), order_.end(),
              [&](std::uint32_t i, std::uint32_t j) { return before(old_pairs_[i], old_pairs_[j]); });
}

// The first of the old pairs, in order, that is not before this one.
std::size_t WarmStart::Impl::place_of(const Pair& pair) const {
    std::size_t low = 0, high = old_pairs_.size();
    while (low < high) {
        const std::size_t middle = low + (high - low) / 2;
        if (before(old_pairs_[old_number(middle)], pair))
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

std::size_t WarmStart::Impl::take(View<const Pair> now) {
    std::swap(pairs, old_pairs_);
    std::swap(corners, old_corners_);
    sort_old();
    pairs.assign(now.begin(), now.end());
    corners.resize(now.size());
    return restore(0, pairs.size());
}

std::size_t WarmStart::Impl::restore(std::size_t first, std::size_t count) {
    const std::size_t parts = (count + pairs_a_part - 1) / pairs_a_part;
    std::vector<std::size_t> known(parts, 0);
    detail::parallel_for(parts, parts > 1, [&](std::size_t p) {
        const std::size_t begin = first + p * pairs_a_part;
        std::size_t at = 0;
        for (std::size_t i = begin; i < std::min(first + count, begin + pairs_a_part); ++i) {
            if (i == begin || before(pairs[i], pairs[i - 1])) at = place_of(pairs[i]);
            while (at < old_pairs_.size() && before(old_pairs_[old_number(at)], pairs[i])) ++at;
            const bool there = at < old_pairs_.size() && !before(pairs[i], old_pairs_[old_number(at)]);
            corners[i] = there ? old_corners_[old_number(at)] : Corners{{none, none, none, none}};
            known[p] += corners[i].any() ? 1U : 0U;
        }
    });
    return std::accumulate(known.begin(), known.end(), std::size_t{0});
}

void WarmStart::Impl::clear() noexcept {
    pairs.clear();
    corners.clear();
}

WarmStart::WarmStart() : impl_(std::make_unique<Impl>()) {}
WarmStart::~WarmStart() = default;
WarmStart::WarmStart(WarmStart&& other) noexcept = default;
WarmStart& WarmStart::operator=(WarmStart&& other) noexcept = default;

void WarmStart::clear() noexcept {
    impl_->clear();
}

std::size_t WarmStart::size() const noexcept {
    return static_cast<std::size_t>(std::count_if(impl_->corners.begin(), impl_->corners.end(),
                                                  [](const Impl::Corners& corners) { return corners.any(); }));
}

}  // namespace clinch
