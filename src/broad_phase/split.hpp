// One broad phase on several devices: each finds the pairs of one slab of space, with whatever algorithm [thesis 5.2].
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clinch/broad_phase.hpp"
#include "src/broad_phase/algorithm.hpp"
#include "src/broad_phase/slab_worker.hpp"
#include "src/broad_phase/slabs.hpp"
#include "src/device/context_impl.hpp"
#include "src/schedule/steady_shares.hpp"

namespace clinch::detail {

/// Keeps, of each device, its algorithms and buffers, and how fast it was.
class BroadSplit {
public:
    BroadSplit(Context::Impl& context, const BroadPhaseOptions& options);
    ~BroadSplit();
    BroadSplit(const BroadSplit&) = delete;
    BroadSplit& operator=(const BroadSplit&) = delete;

    /// Whether `count` boxes are worth more than one device to `row`. Opens none.
    bool pays(const AlgorithmRow& row, std::uint64_t count) const;
    /// As BroadPhaseAlgorithm::find, to the byte; `pairs` keeps or counts them. A device that fails is retired, and
    /// another one does its slab; when none is left what it threw leaves. False, with no pairs found, if so many boxes
    /// reach over the cuts that it does not pay; devices may have failed even so.
    bool find(const AlgorithmRow& row, BoxInput& boxes, const FilterInput& filters, PairList& pairs,
              FindCounts& counts);
    /// A call begins that streams from the devices of `crew`, or, if that is empty, those that pays() speaks of. Gives
    /// back what other devices have; no device must be at work. Opens none.
    void begin_stream(const AlgorithmRow& row, BoxInput& boxes, std::vector<std::size_t> crew);
    /// Then: the same pairs as find(), not kept but handed over as they are found; how many. Touches no other device.
    /// One that fails is the caller's affair: throws DeviceFault. All else that is thrown, by `taker`, too, leaves.
    std::uint64_t stream(const AlgorithmRow& row, BoxInput& boxes, const FilterInput& filters, const PairTaker& taker,
                         FindCounts& counts);
    /// For tests: shares of the devices, the primary first, in place of those that were measured.
    void force(std::vector<double> fractions) { forced_ = std::move(fractions); }
    /// What each device did in the last call.
    std::vector<DeviceWork> work() const;
    /// Devices that failed in the last call.
    const std::vector<std::string>& warnings() const noexcept { return warnings_; }
    std::size_t host_bytes() const noexcept { return deal_.host_bytes(); }
    /// Unmaps the lists of slabs, which other work on the devices may write over.
    void forget_pairs();

private:
    void start_call();
    std::vector<std::size_t> crew_for(const AlgorithmRow& row, std::uint64_t count) const;
    std::vector<double> fractions_of(const std::vector<std::size_t>& crew) const;
    bool deal(View<const Aabb> boxes, const std::vector<std::size_t>& crew);
    bool settle(const AlgorithmRow& row, View<const Aabb> boxes, const std::vector<std::size_t>& crew, bool send);
    bool keep(const AlgorithmRow& row, View<const Aabb> boxes, bool send);
    void prepare(const std::vector<std::size_t>& crew);
    std::optional<KeyLayout> keys_for(std::uint64_t boxes) const;
    void run(const SlabTask& task);
    void run_in_place(const SlabTask& task);
    std::vector<std::exception_ptr> run_once(const SlabTask& task, const std::vector<std::size_t>& which);
    std::vector<std::size_t> reassign(const AlgorithmRow& row, const std::vector<std::size_t>& which,
                                      const std::vector<std::exception_ptr>& thrown);
    [[noreturn]] void throw_limit(const SlabTask& task);
    void gather(bool counts_only, PairList& pairs, FindCounts& counts);
    void add_counts(FindCounts& counts) const;
    void measure();

    Context::Impl& context_;
    const BroadPhaseOptions& options_;
    SteadyShares shares_;  // of the devices of the context
    std::vector<double> forced_;
    SlabDeal deal_;
    std::vector<std::size_t> dealt_to_;                 // who has which slab of it
    std::vector<double> dealt_;                         // the shares it was made for
    std::vector<std::unique_ptr<SlabWorker>> workers_;  // of each slab
    std::vector<std::string> warnings_;
};

}  // namespace clinch::detail
