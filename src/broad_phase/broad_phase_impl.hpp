// What stands behind clinch::BroadPhase.
#pragma once

#include <map>
#include <memory>

#include "clinch/broad_phase.hpp"
#include "src/broad_phase/algorithm.hpp"
#include "src/device/context_impl.hpp"

namespace clinch {

struct BroadPhase::Impl {
    Context::Impl& context;
    BroadPhaseOptions options;
    detail::Buffer staging;  // boxes of the host on the device
    std::map<const detail::AlgorithmRow*, std::unique_ptr<detail::BroadPhaseAlgorithm>> made;
    detail::PairList pairs;  // after `made`, whose buffers it may map: it ends first
    Report report;

    Impl(Context& c, BroadPhaseOptions o);
    /// The algorithm for `count` boxes.
    const detail::AlgorithmRow& choose(std::uint64_t count) const;
    /// The device that algorithms work on; opens it.
    detail::Device& device() const;
    /// Finds the pairs of `boxes` with `row`; boxes that are no boxes are listed if `list_rejected`.
    View<const Pair> find(const detail::AlgorithmRow& row, detail::BoxInput& boxes, const detail::FilterInput& filters,
                          bool list_rejected);
    /// The same into `pairs` as it is set up.
    void run(const detail::AlgorithmRow& row, detail::BoxInput& boxes, const detail::FilterInput& filters,
             bool list_rejected);
};

}  // namespace clinch
