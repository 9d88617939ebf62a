// One device's half of a narrow phase that may be split: its worker, the chunks in its hands, and what it sets aside.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "src/narrow_phase/chunk_work.hpp"
#include "src/narrow_phase/contact_places.hpp"
#include "src/narrow_phase/narrow_result.hpp"
#include "src/narrow_phase/narrow_worker.hpp"

namespace clinch::detail {

/// A chunk that is done is written to its place in the result as soon as that is known. Until then it stays on the
/// device while the next chunk is done in memory of its own; when that must wait, too, the older one is set aside. In
/// the thread of the device.
class NarrowMember {
public:
    NarrowMember(Device& device, NarrowSettings& settings) : worker_(device, settings), first_(worker_) {}

    NarrowWorker& worker() noexcept { return worker_; }
    /// A call begins. What was in its hands or set aside is forgotten.
    void start_call();

    /// Does chunk number `chunk`, the pairs from `first` on, to its end and appends it to the result: for a call that
    /// has no other device.
    void append_chunk(const NarrowCall& call, std::size_t first, std::size_t count, NarrowResult& result);

    /// Does all pairs of the call as one chunk and writes what they have to the next rows of the result, which several
    /// members share: `next` is the first row that nobody has taken. Returns the first of its rows and how many.
    std::pair<std::size_t, std::size_t> put_chunk(const NarrowCall& call, std::atomic<std::size_t>& next,
                                                  NarrowResult& result);

    /// Does a chunk, tells `places` how much it has, and writes what may be written. An error leaves the chunks before
    /// in its hands.
    void do_chunk(const NarrowCall& call, std::uint32_t chunk, std::size_t first, std::size_t count,
                  ContactPlaces& places, NarrowResult& result);
    /// Writes or sets aside what is in its hands; needs the device no more.
    void settle(const NarrowCall& call, ContactPlaces& places, NarrowResult& result);
    /// Copies what was set aside to its place, when all chunks are done. By any thread.
    void copy_set_aside(const NarrowCall& call, const ContactPlaces& places, NarrowResult& result);

private:
    struct InHand {
        std::uint32_t chunk;
        ChunkWork* work;
    };
    struct SetAside {
        std::uint32_t chunk;
        std::size_t first, count;  // rows of aside_
    };
    ChunkWork& free_work(const NarrowCall& call, ContactPlaces& places, NarrowResult& result);
    void write_known(const NarrowCall& call, ContactPlaces& places, NarrowResult& result);
    void set_aside(const NarrowCall& call);

    NarrowWorker worker_;
    ChunkWork first_;
    std::unique_ptr<ChunkWork> second_;  // made when first needed
    std::deque<InHand> in_hand_;         // at most two, the older first
    NarrowResult aside_;
    std::vector<SetAside> set_aside_;
};

}  // namespace clinch::detail
