// One step in which both phases are at work: who does what, and the chunks of pairs between them.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/report.hpp"
#include "clinch/view.hpp"
#include "src/broad_phase/algorithm.hpp"
#include "src/narrow_phase/narrow_stream.hpp"
#include "src/schedule/chunk_buffer.hpp"

namespace clinch::detail {

/// Which devices do what. Those of `alike` may help the narrow phase; where there are none the host does all of it.
struct PhaseRoles {
    std::vector<std::size_t> broad;   ///< none: the host finds the pairs
    std::vector<std::size_t> narrow;  ///< of those alike, the ones that are not in the broad phase
    std::vector<std::size_t> alike;
};

/// Lives for one step. Memory for pairs: of the chunks that wait, two for each device of the narrow phase and two more;
/// of one in each device's hands, in either phase.
class PhaseRun {
public:
    /// Thrown to who finds pairs that nobody needs any more.
    struct Stopped {};
    /// In place of a device.
    static constexpr std::size_t host = ~std::size_t{0};

    using Chunk = std::vector<Pair>;
    /// Of chunks that were done, for the next ones: fresh memory costs more than filling it.
    struct Memory {
        std::mutex mutex;
        std::vector<Chunk> spare;
    };

    /// `chunk_pairs` must be at least NarrowStream::few_pairs. `help`: whether devices of the broad phase do chunks,
    /// too; they do anyway where nobody else would.
    PhaseRun(NarrowStream& narrow, const PhaseRoles& roles, std::size_t chunk_pairs, bool help, Memory& memory);

    /// Calls `find_pairs`, which calls take(), while chunks are done; all are done when it returns. With `expected`,
    /// devices of the narrow phase get ready before there is a chunk. What each thread threw: DeviceFault what a device
    /// did; Stopped who was in the middle of something when another one threw.
    using FindPairs = std::function<void(FindCounts&)>;
    std::vector<std::exception_ptr> run(const FindPairs& find_pairs, bool expected);
    /// Pairs that were found, in the thread of that device, or `host`.
    void take(std::size_t device, View<const Pair> pairs);
    /// None more come for a while from there: devices of the narrow phase that wait can have these.
    void pause(std::size_t device);
    /// Pairs that should be found at a time, at most.
    std::size_t piece() const noexcept { return 2 * chunk_pairs_; }
    /// Where pairs go that no device of the broad phase has found.
    std::size_t broad_place() const noexcept { return roles_.broad.empty() ? host : roles_.broad.front(); }

    std::uint64_t pairs() const noexcept { return pairs_; }
    const FindCounts& counts() const noexcept { return counts_; }
    double broad_ms() const noexcept { return broad_ms_; }
    double narrow_ms() const noexcept { return narrow_ms_; }
    /// The sum of what devices worked on chunks.
    double narrow_work_ms() const;
    StreamWork work() const;

private:
    // What belongs to one device, or the host: its chunk to the thread that finds pairs there, its time to the one that
    // does chunks.
    struct Hands {
        Chunk chunk;  // that is being filled
        double narrow_ms = 0.0;
        std::uint64_t pairs = 0;
    };
    bool helps(std::size_t device) const;
    void deliver(std::size_t device, Chunk& chunk);
    void find_all(const FindPairs& find_pairs);
    void flush();
    template <class Work>
    void work_on(std::size_t device, const Work& work);
    void do_chunk(std::size_t device, Chunk chunk);
    void do_all(std::size_t device, bool get_ready);
    Chunk fresh();

    NarrowStream& narrow_;
    const PhaseRoles& roles_;
    std::size_t chunk_pairs_, most_waiting_;
    bool help_;
    ChunkBuffer<Chunk> buffer_;
    std::map<std::size_t, Hands> hands_;  // none comes or goes while threads work
    Memory& memory_;
    std::atomic<std::uint64_t> chunks_{0};
    FindCounts counts_;
    std::uint64_t pairs_ = 0;
    double broad_ms_ = 0.0, narrow_ms_ = 0.0;
};

}  // namespace clinch::detail
