// The chunks of one call, dealt to devices by their share of the work and stolen by those that are done early
// [thesis 5.3.2].
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <vector>

namespace clinch::detail {

/// Hands out the chunks 0 .. n-1, each exactly once (again only when the taker that held it fails). All functions may
/// be called by any thread at any time; none waits for another taker.
///
/// Every taker begins with an amount in proportion to its fraction (largest remainder). Chunks are numbered in the
/// order in which they are expected to be finished: a taker's k-th (from 0) at (k + 1) / fraction, ties by taker; so
/// results can be put in order as they come.
class ChunkQueue {
public:
    /// What taking chunks over costs a device.
    struct Taker {
        double fraction;                ///< of the work, in any unit, 0 or more; all 0: equal amounts
        double seconds_a_chunk = 0.0;   ///< as measured before; 0: unknown
        double seconds_to_begin = 0.0;  ///< what must be sent before its first chunk: paid once, by who has not begun
    };

    /// Throws Error (InvalidArgument) if a number is negative or not finite. Cost: chunks * log(takers).
    ChunkQueue(std::uint32_t chunks, const std::vector<Taker>& takers);

    /// The next chunk for `taker`: of its own, ascending. If it has none left, half (rounded up, the highest-numbered)
    /// of what is left to the one that will take longest become its own first. Less than half if only that pays, and
    /// nothing if by the measured times that one would be done sooner by itself than the taker with a single chunk;
    /// where a time is unknown, half is always taken. nullopt: there is nothing (left) for it now; it may ask again,
    /// and should when a taker was retired. Cost: constant, a step for each taker and stolen chunk when it steals.
    std::optional<std::uint32_t> take(std::size_t taker);

    /// The taker fails: what it has left, and the chunk `in_hand` it took and did not finish, go to the others, by
    /// their fractions, before the higher-numbered ones they have (those last told nullopt get some only if there are
    /// no others). If no taker is left the chunks stay, counted by left(). May be called again for further chunks in
    /// hand. Throws Error (InvalidArgument) if `in_hand` is not in this taker's hands.
    void retire(std::size_t taker, std::optional<std::uint32_t> in_hand);

    /// How many chunks were handed to this taker, without those it gave back as it failed; the sum over all takers and
    /// left() is the number of chunks.
    std::uint32_t taken(std::size_t taker) const;
    /// How many of those had been dealt to others.
    std::uint32_t stolen(std::size_t taker) const;
    /// How many chunks are not handed out.
    std::uint32_t left() const;

private:
    struct State {
        Taker cost;
        double pace;                      // seconds a chunk; where unmeasured, a guess that ranks it among the others
        std::deque<std::uint32_t> own{};  // ascending
        std::uint32_t taken = 0, stolen = 0;
        bool retired = false;
        bool resting = false;  // was told nullopt last
    };
    struct Chunk {
        std::uint32_t dealt_to, held_by;
    };

    void deal(const std::vector<std::uint32_t>& chunks, const std::vector<std::size_t>& to);
    void guess_paces();
    double seconds_left(const State& victim) const;
    std::size_t pays(const State& thief, const State& victim) const;
    bool steal(State& thief);
    std::vector<std::size_t> heirs() const;

    mutable std::mutex mutex_;
    std::vector<State> takers_;
    std::vector<Chunk> chunks_;
    std::uint32_t left_ = 0;
};

}  // namespace clinch::detail
