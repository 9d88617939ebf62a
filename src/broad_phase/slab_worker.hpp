// The pairs of one slab on one device.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "clinch/broad_phase.hpp"
#include "src/broad_phase/algorithm.hpp"
#include "src/broad_phase/slab_merge.hpp"
#include "src/broad_phase/slabs.hpp"
#include "src/device/context_impl.hpp"

namespace clinch::detail {

/// Where the pairs of a call go that streams them.
struct PairTaker {
    /// Called with pairs that belong to the slab of device number `device`, in no order, as numbers of boxes; in the
    /// thread of that device, those of several devices at once. May throw, which ends the slab.
    std::function<void(std::size_t device, View<const Pair> pairs)> take;
    std::size_t piece;  ///< pairs a device has at a time, at most
};

/// What all workers of a call are given.
struct SlabTask {
    const AlgorithmRow& row;
    View<const Aabb> boxes;
    const FilterInput& filters;
    const SlabDeal& deal;
    bool counts_only;
    /// As what lists of names may come; the same from all slabs, so that they can be merged as they are.
    std::optional<KeyLayout> keys;
    const PairTaker* taker = nullptr;  ///< else workers keep their pairs
};

/// Keeps its device's algorithms and buffers from call to call. One thread at a time; workers of different devices work
/// side by side.
class SlabWorker {
public:
    SlabWorker(Context::Impl& context, const BroadPhaseOptions& options) : context_(context), options_(options) {}

    /// Works on this device from now on; what it had on another one is given back.
    void assign(std::size_t device);
    std::size_t device() const noexcept { return device_; }
    /// As its algorithms are to have them.
    BroadPhaseOptions& options() noexcept { return options_; }

    /// Room on the device, which it opens if need be, for the boxes of `members` members: find() searches what was
    /// written there before. Null without any, or if the device fails: then find() throws what it threw.
    Aabb* room_for(std::size_t members) noexcept;
    /// Finds the pairs of slab s, or only counts them.
    void find(const SlabTask& task, std::size_t s);

    /// What was found.
    SlabList pairs() const noexcept { return {pairs_.view(), counts_.named, in_range_, pairs_.keys()}; }
    /// How many pairs were found in the slab; of a stream, those that belong to it.
    std::uint64_t found() const noexcept { return found_; }
    /// How many of them belong to it; only where they were counted.
    std::uint64_t counted() const noexcept { return counted_; }
    const FindCounts& counts() const noexcept { return counts_; }
    /// Wall time of the last find(), without that of building kernels and of who took the pairs of a stream.
    double seconds() const noexcept { return seconds_; }
    void forget_pairs() { pairs_.clear(); }
    void forget_room() noexcept;

private:
    void count(const SlabTask& task, std::size_t s);
    void stream(const SlabTask& task, std::size_t s);
    void search(const SlabTask& task, const std::vector<std::uint32_t>& members);
    const Buffer& send(Device& device, const SlabTask& task, const std::vector<std::uint32_t>& members);
    void name(Device& device, const SlabTask& task, BoxInput& input);
    FilterInput filters_of(const FilterInput& filters, const std::vector<std::uint32_t>& members);

    Context::Impl& context_;
    BroadPhaseOptions options_;
    std::size_t device_ = 0;
    std::size_t slab_ = 0, names_slab_ = 0;
    std::uint64_t names_version_ = 0;  // of the deal that names_ are of; 0: none
    Buffer staging_, names_;
    Mapping room_;  // of staging_
    std::exception_ptr no_room_;
    std::map<const AlgorithmRow*, std::unique_ptr<BroadPhaseAlgorithm>> made_;
    PairList pairs_;  // after `made_`, whose buffers it may map: it ends first
    FindCounts counts_;
    bool in_range_ = false;  // all that were found
    std::uint64_t found_ = 0, counted_ = 0;
    double seconds_ = 0.0, taken_ms_ = 0.0;
    std::vector<Pair> owned_;  // of a piece of a stream
    std::vector<std::uint32_t> group_, mask_;
    std::vector<Motion> motion_;
};

}  // namespace clinch::detail
