// A process that holds one peer of the narrow phase.
#pragma once

#include <array>
#include <cstdint>

#include "bench/peers/narrow/judge.hpp"
#include "bench/peers/narrow/peer.hpp"
#include "bench/peers/process.hpp"

namespace clinch::peers::narrow {

/// What a worker says of one job.
struct Turn {
    static constexpr unsigned most_runs = 256;
    bool done = false;
    unsigned runs = 0;
    std::array<double, most_runs> ms{};           ///< of each run
    std::array<double, most_runs> cpu_ms{};       ///< of each run: what the process had of processors
    std::array<double, most_runs> routines_ms{};  ///< of as many runs apart; 0 where nobody measures that
    Verdict verdict;                              ///< of the first run
    std::uint64_t peak_bytes = 0;                 ///< of the process
    std::array<char, 240> text{};                 ///< why not done
};

/// Runs a peer in a child process, on one core if its row says so; see Process.
class Worker {
    struct Command {
        char job;
        double enough_ms;
    };

public:
    /// All are read by the child. `core`: the number of the one core.
    Worker(const PeerRow& row, const Batch& batch, Question question, unsigned core);

    /// Makes the peer and judges its answers.
    Turn first_run(double most_seconds) { return process_.ask<Command, Turn>({'f', 0.0}, most_seconds); }
    /// Runs until `enough_ms` are over, at least once; of several runs the first is not counted.
    Turn more_runs(double enough_ms, double most_seconds) {
        return process_.ask<Command, Turn>({'m', enough_ms}, most_seconds);
    }

private:
    Process process_;
};

}  // namespace clinch::peers::narrow
