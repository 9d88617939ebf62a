// One scene, all peers, in rounds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/peers/peer.hpp"

namespace clinch::peers {

struct SceneName {
    std::string kind;
    std::size_t count = 0;
    std::uint64_t seed = 1;
};

struct Rules {
    unsigned rounds = 5;
    double enough_ms = 40.0;                            ///< a peer's turn in a round, for scenes that take less
    double most_seconds = 20.0;                         ///< for one run
    std::uint64_t most_bytes = std::uint64_t{8} << 30;  ///< of all peers together; above it they live one at a time
    unsigned threads = 2;
    /// After a first round, peers whose shortest run is so many times that of the fastest are run no more; 0: all are.
    double hopeless = 0.0;
};

struct Result {
    PeerRow row;
    std::vector<double> ms;  ///< of all counted runs
    std::uint64_t pairs = 0, mark = 0, peak_bytes = 0;
    std::string note;    ///< why there are no times or no more of them
    std::string chosen;  ///< the algorithm of the last run, where the peer has a choice
    bool right = false;  ///< the same pairs as clinch, compared by number and by a sum over them

    /// 0 without any.
    double median_ms() const;
};

struct Outcome {
    SceneName scene;
    std::uint64_t pairs = 0;  ///< as the first of clinch's algorithms found them
    std::vector<Result> results;
};

/// Runs each of `rows` once and takes its pairs, then all in turn, round after round, so that noise hits all alike.
/// Runs change between the scene and the same kind with another seed, so that none profits from the run before; both
/// are timed. Errors of peers are notes; those of the scene are clinch::Error.
Outcome measure(const SceneName& scene, const std::vector<PeerRow>& rows, const Rules& rules);

}  // namespace clinch::peers
