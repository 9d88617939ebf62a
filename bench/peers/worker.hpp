// A process that holds one peer.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/peers/peer.hpp"
#include "bench/peers/process.hpp"

namespace clinch::peers {

/// What a worker says of one job.
struct Answer {
    static constexpr unsigned most_runs = 32;
    bool done = false;
    unsigned runs = 0;
    std::array<double, most_runs> ms{};  ///< of each run
    std::uint64_t pairs = 0;             ///< of the first scene, at the first job
    std::uint64_t mark =
        0;  ///< of both scenes, at the first job: a sum over the pairs that does not depend on their order
    std::uint64_t peak_bytes = 0;   ///< of the process
    std::array<char, 240> text{};   ///< why not done
    std::array<char, 24> chosen{};  ///< the algorithm of the last run, where the peer has a choice
};

/// Two scenes that take turns, so that nothing found out in one run is of use in the next; the first is the one
/// reported.
using Scenes = std::array<std::vector<Aabb>, 2>;

/// Runs a peer in a child process; see there.
class Worker {
    struct Command {
        char job;
        double enough_ms;
        std::uint64_t pairs;
    };

public:
    /// `row`, `scenes` and `setup` are read by the child; the caller's may go.
    Worker(const PeerRow& row, const Scenes& scenes, const Setup& setup);

    /// Makes the peer and runs it on both scenes, untouched memory and all; takes the mark.
    Answer first_run(double most_seconds) { return ask({'f', 0.0, 0}, most_seconds); }
    /// The same on the second scene alone, in a worker made anew for a peer that found `pairs` in the first scene
    /// before.
    Answer warm_up(std::uint64_t pairs, double most_seconds) { return ask({'w', 0.0, pairs}, most_seconds); }
    /// Runs until `enough_ms` are over, at least once; of several runs the first is not counted. Another number of
    /// pairs than at first is a failure.
    Answer more_runs(double enough_ms, double most_seconds) { return ask({'m', enough_ms, 0}, most_seconds); }

private:
    Answer ask(const Command& command, double most_seconds) {
        return process_.ask<Command, Answer>(command, most_seconds);
    }
    static void serve(const PeerRow& row, const Scenes& scenes, const Setup& setup, int commands, int answers);

    Process process_;
};

}  // namespace clinch::peers
