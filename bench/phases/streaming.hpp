// Scenes of falling bodies, stepped by pipelines with both phases at once and with one after the other
// [thesis 6.1.4.1].
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/machines/phases.hpp"
#include "clinch/context.hpp"

namespace clinch::phases {

/// How a pipeline does a step; all but the first on two devices.
enum class Way : std::uint8_t {
    Sequence,    ///< one device: broad, then narrow phase
    PhaseEach,   ///< streamed, each phase on a device of its own, neither helps the other
    Streamed,    ///< streamed, who is done early helps
    EachOnBoth,  ///< broad, then narrow phase, each on both devices
};
constexpr std::array<const char*, 4> way_names{"sequence", "streamed, a device a phase", "streamed", "both split"};

/// What is played.
struct Play {
    std::string kind;
    std::size_t bodies;
    std::uint64_t seed;
    std::uint32_t contacts_per_pair;
};

/// One frame, as each Way has stepped it.
struct Frame {
    std::size_t frame;
    std::uint64_t pairs, contacts;
    std::array<double, way_names.size()> ms;  ///< wall time of the step
    double broad_ms, narrow_ms;               ///< of the sequence
    std::uint64_t pair_bytes;                 ///< that Way::Streamed held at most
};

struct Played {
    std::size_t frames;          ///< from the first to the one in which the last body comes to rest
    std::vector<Frame> stepped;  ///< those that were measured
    Frame rest;                  ///< the last, of which only pairs and contacts are set
};

/// Measures the parts of one CPU. Needs two compute units.
class Bench {
public:
    explicit Bench(const DeviceInfo& cpu);

    /// Plays until all bodies rest; measures one of `every` frames, four in a row, which each way steps before the next
    /// way does (two unmeasured ones first), as a program steps one frame after the other. All pipelines find all pairs
    /// anew. Throws std::runtime_error if they do not find the same contacts, to the byte.
    Played compare(const Play& play, std::size_t every);

    /// Plays once more, with the sequence alone: what each phase takes of one core in each frame but the first, in
    /// unit-seconds. Making the boxes counts for neither phase.
    std::vector<machines::PhaseLoad> loads(const Play& play);

private:
    Context one_, two_;
};

}  // namespace clinch::phases
