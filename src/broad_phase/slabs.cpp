#include "src/broad_phase/slabs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "src/broad_phase/box_sample.hpp"
#include "src/primitives/host_parallel.hpp"

namespace clinch::detail {
namespace {

constexpr std::size_t sample_size = 4096, centres_size = 65536, boxes_a_block = std::size_t{1} << 15;
constexpr double slack_widths = 0.25;  // of boxes: bodies that move much farther in a step are few

using Floats = std::vector<float>::iterator;
using Places = std::vector<std::size_t>::const_iterator;

// Brings to some places, ascending, the values that all from `start` on would have there if they were in order. Those
// places, and the values, are in [first, last).
void bring_to_places(Floats start, Floats first, Floats last, Places place, Places places_end) {
    if (place == places_end) return;
    const Places middle = place + (places_end - place) / 2;
    const Floats nth = start + static_cast<std::ptrdiff_t>(*middle);
    std::nth_element(first, nth, last);
    bring_to_places(start, first, nth, place, middle);
    bring_to_places(start, nth + 1, last, middle + 1, places_end);
}

// Cuts by which boxes with these `centres`, one at least, lie in slabs as `fractions` say.
std::vector<float> cuts_for(std::vector<float> centres, const std::vector<double>& fractions) {
    std::vector<std::size_t> places;
    double before = 0.0;
    for (std::size_t s = 0; s + 1 < fractions.size(); ++s) {
        before += fractions[s];
        places.push_back(static_cast<std::size_t>(std::clamp(before, 0.0, 1.0) * static_cast<double>(centres.size())));
    }
    std::vector<std::size_t> each = places;
    each.erase(std::unique(each.begin(), each.end()), each.end());
    while (!each.empty() && each.back() >= centres.size()) each.pop_back();
    bring_to_places(centres.begin(), centres.begin(), centres.end(), each.begin(), each.end());
    std::vector<float> cuts;
    cuts.reserve(places.size());
    for (const std::size_t place : places) {
        // All boxes lie behind the first place, and before one behind the last.
        const float cut = place == 0 ? -HUGE_VALF : place < centres.size() ? centres[place] : HUGE_VALF;
        constexpr float least = std::numeric_limits<float>::min();
        cuts.push_back(std::fabs(cut) < least ? least : cut);
    }
    return cuts;
}

Slabs slabs_across(int axis, const std::vector<Aabb>& sample, const std::vector<double>& fractions) {
    Slabs slabs;
    slabs.axis = axis;
    slabs.cuts = cuts_for(centres_of({sample.data(), sample.size()}, axis, sample.size()), fractions);
    double width = 0.0;
    for (const Aabb& box : sample)
        width += (static_cast<double>(box.max[axis]) - static_cast<double>(box.min[axis])) /
                 static_cast<double>(sample.size());
    slabs.slack = static_cast<float>(slack_widths * width);
    std::size_t copies = 0;
    for (const Aabb& box : sample) {
        const SlabSpan span = slabs.members_of(box);
        copies += static_cast<std::size_t>(span.last - span.first);
    }
    slabs.copies = static_cast<double>(copies) / static_cast<double>(sample.size());
    return slabs;
}

}  // namespace

Slabs choose_slabs(View<const Aabb> boxes, const std::vector<double>& fractions) {
    Slabs best;
    const std::vector<Aabb> sample = sample_of(boxes, std::min(sample_size, boxes.size()));
    if (sample.empty()) {
        best.cuts.assign(fractions.size() - 1, 0.0f);
        return best;
    }
    for (int axis = 0; axis < 3; ++axis) {
        Slabs slabs = slabs_across(axis, sample, fractions);
        if (axis == 0 || slabs.copies < best.copies) best = std::move(slabs);
    }
    std::vector<float> centres = centres_of(boxes, best.axis, centres_size);
    if (!centres.empty()) best.cuts = cuts_for(std::move(centres), fractions);
    return best;
}

namespace {

// Calls what(i) for each box of a block.
template <class What>
void each_of(std::size_t block, std::size_t boxes, const What& what) {
    for (std::size_t i = block * boxes_a_block, end = std::min(boxes, i + boxes_a_block); i < end; ++i) what(i);
}

}  // namespace

bool SlabDeal::keep(View<const Aabb> boxes, const std::vector<Aabb*>& rows, bool spans) {
    const std::size_t n = boxes.size(), blocks = (n + boxes_a_block - 1) / boxes_a_block, count = members_.size();
    if (n != spans_.size() || count != slabs_.count()) return false;
    std::vector<float> lows, highs;
    for (std::size_t s = 0; s < count; ++s) {
        lows.push_back(slabs_.low(s));
        highs.push_back(s + 1 < count ? slabs_.high(s) : std::numeric_limits<float>::quiet_NaN());  // nothing is beyond
    }
    std::vector<std::uint8_t> strays(blocks, 0);
    parallel_for(blocks, blocks > 1, [&](std::size_t block) {
        std::vector<Aabb*> to(rows);
        to.resize(count, nullptr);
        for (std::size_t s = 0; s < count; ++s)
            if (to[s] != nullptr) to[s] += places_[block * count + s];
        unsigned stray = 0;
        const Aabb* const all = boxes.data();
        const SlabSpan* const member_of = member_of_.data();
        each_of(block, n, [=, axis = slabs_.axis, low = lows.data(), high = highs.data(), &to, &stray](std::size_t i) {
            const SlabSpan in = member_of[i];
            stray |= static_cast<unsigned>(all[i].min[axis] < low[in.first]) |
                     static_cast<unsigned>(all[i].max[axis] >= high[in.last]);
            for (std::size_t s = in.first; s <= in.last; ++s)
                if (to[s] != nullptr) *to[s]++ = all[i];
        });
        if (spans) each_of(block, n, [&](std::size_t i) { spans_[i] = slabs_.span_of(all[i]); });
        strays[block] = static_cast<std::uint8_t>(stray);
    });
    return std::find(strays.begin(), strays.end(), 1) == strays.end();
}

void SlabDeal::deal(View<const Aabb> boxes, const Slabs& slabs) {
    const std::size_t n = boxes.size(), count = slabs.count(), blocks = (n + boxes_a_block - 1) / boxes_a_block;
    slabs_ = slabs;
    ++version_;
    spans_.resize(n);
    member_of_.resize(n);
    members_.resize(count);
    places_.assign(blocks * count, 0);
    parallel_for(blocks, blocks > 1, [&](std::size_t block) {
        std::vector<std::size_t> there(count, 0);
        each_of(block, n, [&](std::size_t i) {
            spans_[i] = slabs.span_of(boxes[i]);
            SlabSpan& in = member_of_[i] = slabs.members_of(boxes[i]);
            // Rounding, and what is no box, may have it the other way.
            in = {std::min(in.first, spans_[i].first), std::max(in.last, spans_[i].last)};
            for (std::size_t s = in.first; s <= in.last; ++s) ++there[s];
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
        each_of(block, n, [&](std::size_t i) {
            for (std::size_t s = member_of_[i].first; s <= member_of_[i].last; ++s)
                *at[s]++ = static_cast<std::uint32_t>(i);
        });
    });
}

std::size_t SlabDeal::host_bytes() const noexcept {
    std::size_t bytes =
        (spans_.capacity() + member_of_.capacity()) * sizeof(SlabSpan) + places_.capacity() * sizeof(std::size_t);
    for (const auto& members : members_) bytes += members.capacity() * sizeof(std::uint32_t);
    return bytes;
}

}  // namespace clinch::detail
