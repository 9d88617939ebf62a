// The devices of a narrow phase: which of them a call is large enough for, and what happens when one fails.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "clinch/narrow_phase.hpp"
#include "src/device/context_impl.hpp"
#include "src/narrow_phase/narrow_call.hpp"
#include "src/narrow_phase/narrow_member.hpp"
#include "src/narrow_phase/slots.hpp"
#include "src/schedule/chunk_queue.hpp"
#include "src/schedule/shares.hpp"

namespace clinch::detail {

/// Opens a device when a call first has work for it, and keeps what was sent there. A call is shared by devices that
/// give the same answers as the context's primary one, by the speeds measured in the calls before.
class NarrowDevices {
public:
    /// Both must outlive this object. Opens nothing.
    NarrowDevices(Context::Impl& context, NarrowSettings& settings) : context_(context), settings_(settings) {}

    /// Finds what the call asks for, for which there is a device, and adds what was done to the report. Devices that
    /// fail are taken out of use. True: the result is whole. False: all that worked on the call failed and others are
    /// left in the context; the result is undefined. Throws Error, that of the last device if none is left.
    bool find(const NarrowCall& call, NarrowResult& result, NarrowReport& report);
    /// A call begins whose pairs come while it runs: the devices that may work on it, the primary one first.
    std::vector<std::size_t> begin_stream();
    /// Sends `device`, one of those, what chunks of such a call need, so that the first need not wait for it. As
    /// find_streamed().
    void prepare_stream(std::size_t device, const NarrowCall& call);
    /// Writes what `device`, one of those, finds of the pairs of such a call: NarrowMember::put_chunk(). Opens it. In
    /// the thread of the device; devices may be at it at once. Throws what went wrong.
    std::pair<std::size_t, std::size_t> find_streamed(std::size_t device, const NarrowCall& call,
                                                      std::atomic<std::size_t>& next, NarrowResult& result);
    /// When all pairs are done: adds to the report what each device did. Whether any pair has a margin.
    bool finish_stream(NarrowReport& report);
    void shapes_changed() noexcept;
    /// After an error: everything is sent anew.
    void forget();

    /// For tests, which make many chunks of few pairs and set what part of them each device is dealt.
    std::size_t chunk_pairs = Slots::chunk_pairs;
    std::vector<double> fractions;

private:
    struct Failure {
        std::size_t device;
        std::exception_ptr why;
    };
    void start_call();
    std::vector<std::size_t> alike() const;
    std::vector<std::size_t> crew_for(std::size_t chunks);
    NarrowMember& member(std::size_t device);
    std::vector<ChunkQueue::Taker> takers_for(const std::vector<std::size_t>& crew, std::size_t chunks) const;
    void find_on_one(const NarrowCall& call, std::size_t device, NarrowResult& result);
    bool find_on_several(const NarrowCall& call, const std::vector<std::size_t>& crew, NarrowResult& result,
                         std::vector<Failure>& failures, NarrowReport& report);
    bool any_margins() const;
    void add_to(NarrowReport& report, std::size_t device, std::uint64_t stolen);
    void learn(std::size_t chunks);
    void retire(const std::vector<Failure>& failures, bool done, NarrowReport& report);

    Context::Impl& context_;
    NarrowSettings& settings_;
    std::vector<std::unique_ptr<NarrowMember>> members_;  // as the context's devices; null until needed
    std::vector<std::size_t> sharing_;                    // devices that shares_ is about
    std::optional<Shares> shares_;
    std::size_t measured_chunks_ = 0;  // of the call that shares_ was last told of
};

}  // namespace clinch::detail
