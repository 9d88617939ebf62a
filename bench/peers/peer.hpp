// What the comparison runs: clinch's algorithms, other libraries and a yardstick behind one interface.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/broad_phase.hpp"
#include "clinch/view.hpp"

namespace clinch::peers {

/// Pairs in host memory, in one list a thread or so. Within a pair either number may come first.
using Lists = std::vector<View<const Pair>>;

/// Something that finds the overlapping pairs of boxes.
class Peer {
public:
    virtual ~Peer() = default;
    /// All pairs of closed boxes that overlap. What is found out about the boxes is found out in this call; memory may
    /// be kept from call to call, as a program would that steps. Calls have the same number of boxes, but other ones.
    /// The lists are valid until the next call. Throws what the library throws.
    virtual Lists run(View<const Aabb> boxes) = 0;
    /// The algorithm that the last call chose; empty for a peer that has no choice.
    virtual std::string chosen() const { return {}; }

protected:
    Peer() = default;
    Peer(const Peer&) = delete;
    Peer& operator=(const Peer&) = delete;
};

/// What a peer is made for.
struct Setup {
    unsigned threads = 2;
    std::uint64_t pairs = 0;  ///< as clinch counts them, for libraries that cut off at a number given beforehand
};

enum class Group {
    Clinch,
    Library,
    Lossy,  ///< a library known to lose pairs: shown, never the best
    Yardstick
};

struct PeerRow {
    std::string name;
    Group group;
    bool threaded;                                            ///< uses Setup::threads, else one thread
    std::string package;                                      ///< the Debian package, or what else it needs
    std::function<std::unique_ptr<Peer>(const Setup&)> make;  ///< empty where it was left out of the build
};

/// Every peer, clinch's algorithms first.
std::vector<PeerRow> peer_rows();

}  // namespace clinch::peers
