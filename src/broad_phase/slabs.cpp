#include "src/broad_phase/slabs.hpp"

#include <algorithm>
#include <cmath>

#include "src/primitives/host_parallel.hpp"

namespace clinch::detail {
namespace {

constexpr std::size_t sample_size = 4096, boxes_a_block = std::size_t{1} << 15;

std::vector<Aabb> sample_of(View<const Aabb> boxes) {
    std::vector<Aabb> sample;
    const std::size_t size = std::min(sample_size, boxes.size());
    sample.reserve(size);
    std::uint32_t random = 1;
    for (std::size_t k = 0; k < size; ++k) {
        random = random * 1664525u + 1013904223u;  // [Knuth, The Art of Computer Programming 2, 3.3.4]
        const Aabb& box = boxes[static_cast<std::size_t>(std::uint64_t{random} * boxes.size() >> 32)];
        bool valid = true;
        for (int d = 0; d < 3; ++d)
            valid = valid && std::isfinite(box.min[d]) && std::isfinite(box.max[d]) && box.min[d] <= box.max[d];
        if (valid) sample.push_back(box);
    }
    return sample;
}

Slabs slabs_across(int axis, const std::vector<Aabb>& sample, const std::vector<double>& fractions) {
    Slabs slabs;
    slabs.axis = axis;
    std::vector<float> begins;
    for (const Aabb& box : sample) begins.push_back(box.min[axis]);
    std::sort(begins.begin(), begins.end());
    double before = 0.0;
    for (std::size_t s = 0; s + 1 < fractions.size(); ++s) {
        before += fractions[s];
        const double place = std::clamp(before, 0.0, 1.0) * static_cast<double>(begins.size());
        // Nothing begins behind the last: a share of all of them ends behind it.
        slabs.cuts.push_back(place >= static_cast<double>(begins.size()) ? std::nextafter(begins.back(), HUGE_VALF)
                                                                         : begins[static_cast<std::size_t>(place)]);
    }
    std::size_t copies = 0;
    for (const Aabb& box : sample) {
        const SlabSpan span = slabs.span_of(box);
        copies += static_cast<std::size_t>(span.last - span.first);
    }
    slabs.copies = static_cast<double>(copies) / static_cast<double>(sample.size());
    return slabs;
}

}  // namespace

SlabSpan Slabs::span_of(const Aabb& box) const noexcept {
    SlabSpan span{0, 0};
    for (const float cut : cuts) {
        span.first = static_cast<std::uint8_t>(span.first + (box.min[axis] >= cut ? 1 : 0));
        span.last = static_cast<std::uint8_t>(span.last + (box.max[axis] >= cut ? 1 : 0));
    }
    span.last = std::max(span.first, span.last);
    return span;
}

Slabs choose_slabs(View<const Aabb> boxes, const std::vector<double>& fractions) {
    Slabs best;
    const std::vector<Aabb> sample = sample_of(boxes);
    if (sample.empty()) {
        best.cuts.assign(fractions.size() - 1, 0.0f);
        return best;
    }
    for (int axis = 0; axis < 3; ++axis) {
        Slabs slabs = slabs_across(axis, sample, fractions);
        if (axis == 0 || slabs.copies < best.copies) best = std::move(slabs);
    }
    return best;
}

void SlabDeal::deal(View<const Aabb> boxes, const Slabs& slabs) {
    const std::size_t n = boxes.size(), count = slabs.count(), blocks = (n + boxes_a_block - 1) / boxes_a_block;
    spans_.resize(n);
    members_.resize(count);
    places_.assign(blocks * count, 0);
    const auto each_of = [&](std::size_t block, const auto& what) {
        for (std::size_t i = block * boxes_a_block, end = std::min(n, i + boxes_a_block); i < end; ++i) what(i);
    };
    parallel_for(blocks, blocks > 1, [&](std::size_t block) {
        std::vector<std::size_t> there(count, 0);
        each_of(block, [&](std::size_t i) {
            const SlabSpan span = spans_[i] = slabs.span_of(boxes[i]);
            for (std::size_t s = span.first; s <= span.last; ++s) ++there[s];
        });
        std::copy(there.begin(), there.end(), places_.begin() + static_cast<std::ptrdiff_t>(block * count));
    });
    for (std::size_t s = 0; s < count; ++s) {
        std::size_t place = 0;
        for (std::size_t block = 0; block < blocks; ++block) {
            const std::size_t there = places_[block * count + s];
            places_[block * count + s] = place;
            place += there;
        }
        members_[s].resize(place);
    }
    parallel_for(blocks, blocks > 1, [&](std::size_t block) {
        std::vector<std::uint32_t*> at(count);
        for (std::size_t s = 0; s < count; ++s) at[s] = members_[s].data() + places_[block * count + s];
        each_of(block, [&](std::size_t i) {
            for (std::size_t s = spans_[i].first; s <= spans_[i].last; ++s) *at[s]++ = static_cast<std::uint32_t>(i);
        });
    });
}

std::size_t SlabDeal::host_bytes() const noexcept {
    std::size_t bytes = spans_.capacity() * sizeof(SlabSpan) + places_.capacity() * sizeof(std::size_t);
    for (const auto& members : members_) bytes += members.capacity() * sizeof(std::uint32_t);
    return bytes;
}

}  // namespace clinch::detail
