// One batch and question, all peers, in rounds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/peers/narrow/judge.hpp"
#include "bench/peers/narrow/peer.hpp"

namespace clinch::peers::narrow {

struct Rules {
    unsigned rounds = 7;
    double enough_ms = 40.0;     ///< a peer's turn in a round, for batches that take less; ten times that on all cores
    double most_seconds = 60.0;  ///< for one turn
    unsigned core = 0;           ///< that peers of one core are bound to
};

struct Result {
    PeerRow row;
    std::vector<double> ns;           ///< a pair, of all counted runs
    std::vector<double> cpu_ns;       ///< the same of processor time, which others at work lengthen less
    std::vector<double> routines_ns;  ///< the same of the routines alone; empty where nobody measures that
    std::size_t pairs = 0;
    std::optional<Verdict> verdict;  ///< none of a yardstick, and where `note` says why
    std::uint64_t peak_bytes = 0;
    std::string note;  ///< why there are no times or no more of them

    double median_ns() const;
    double least_ns() const;  ///< which others at work lengthen least: what peers are compared by
    /// From the first to the third quarter of the runs, as a share of the median.
    double spread() const;
    /// Every answer within what judge.hpp says, or all but so many of the pairs.
    bool right(double but = 0.0) const {
        return verdict && static_cast<double>(verdict->wrong()) <= but * static_cast<double>(pairs);
    }
};

/// Runs each of `rows` once and judges its answers, then all in turn, round after round, so that noise hits all alike.
/// Errors of peers are notes.
std::vector<Result> measure(const Batch& batch, Question question, const std::vector<PeerRow>& rows,
                            const Rules& rules);

/// A library is taken for right that is so of all but one pair in a thousand: one that loses a few pairs of many to its
/// depth search is still what a user would pick.
constexpr double forgiven = 1e-3;

/// The fastest library, by its shortest run, among those taken for right, or among all; null without one.
const Result* fastest_library(const std::vector<Result>& results, bool right);

/// The one named so; null without one that has times.
const Result* find(const std::vector<Result>& results, const std::string& name);

}  // namespace clinch::peers::narrow
