// What the narrow-phase comparison runs: clinch and other libraries behind one interface.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "bench/peers/narrow/batch.hpp"
#include "clinch/pose.hpp"

namespace clinch::peers::narrow {

enum class Question {
    Contact,   ///< of overlapping bodies: depth, normal and a point
    Distance,  ///< of bodies apart: the gap and the points nearest to each other
    Touching   ///< yes or no
};

/// One body pair's answer. What was not asked for is not looked at.
struct Answer {
    bool given = false;  ///< the library came to an end
    bool touching = false;
    double distance = std::numeric_limits<double>::quiet_NaN();  ///< signed
    /// Of any length, from a to b. Distance: 0 where the library gives points alone.
    Vec3 normal;
    Vec3 point;  ///< Contact: where they touch, in both bodies or on a surface. Distance: on a
    Vec3 other;  ///< Distance: on b
};

/// Something that answers all pairs of a batch.
class Peer {
public:
    virtual ~Peer() = default;
    /// What is timed. Objects of the library exist already, nothing is known of the answers but where this is called
    /// again. Throws what the library throws.
    virtual void run() = 0;
    /// Those of the last run, one a pair.
    virtual const std::vector<Answer>& answers() = 0;
    /// Milliseconds that the routines alone take, by a run apart; 0 where nobody measures that.
    virtual double routines_ms() { return 0.0; }

protected:
    Peer() = default;
    Peer(const Peer&) = delete;
    Peer& operator=(const Peer&) = delete;
};

/// A library's peer: answers go straight into a list, as a program would take them.
class ListPeer : public Peer {
public:
    const std::vector<Answer>& answers() override { return answers_; }

protected:
    explicit ListPeer(const Batch& batch) : answers_(batch.pairs()) {}
    std::vector<Answer> answers_;
};

/// How clinch is asked.
struct Way {
    double precision;
    std::uint32_t points = 1;
    bool warm = false;  ///< from what the run before has left
};

enum class Group { Clinch, Library, Yardstick };

struct PeerRow {
    std::string name;
    Group group;
    bool one_core;        ///< bound to one core; else all cores of the process are its own
    std::string package;  ///< the Debian package
    /// Empty where it was left out of the build. Makes nothing for a question or shapes that the library has no answer
    /// for. `batch` outlives the peer.
    std::function<std::unique_ptr<Peer>(const Batch& batch, Question question)> make;
};

/// Every peer, clinch first.
std::vector<PeerRow> peer_rows();

}  // namespace clinch::peers::narrow
