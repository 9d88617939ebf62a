// What answers pairs: clinch's routines in both precisions, on the host and on a device, and libccd beside them.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "clinch/context.hpp"
#include "tests/narrow_phase/closed_form_cases.hpp"

namespace clinch::accuracy {

/// What names a candidate.
struct Title {
    std::string routine;  ///< "own": that of the matrix; "gjk-epa": convex.clh; else of a library
    std::string where;    ///< "host" (one thread) or "device"
    unsigned bits = 64;
    double tolerance = -1;  ///< that the routine stops at, relative to the pair's size; below 0: its own
};
std::string text_of(const Title& title);

/// One answer. Libraries promise no error, and some say of disjoint bodies only that they are so.
struct Found {
    double distance = 0, error = 0;
    std::array<double, 3> normal{};
    bool measured = true;  ///< there is a distance
};

class Candidate {
public:
    explicit Candidate(Title title) : title_(std::move(title)) {}
    virtual ~Candidate() = default;
    Candidate(const Candidate&) = delete;
    Candidate& operator=(const Candidate&) = delete;

    const Title& title() const { return title_; }
    virtual bool promises() const { return true; }
    /// Takes pairs of one cell in, as often as `copies` says.
    virtual void load(const std::vector<test::TruePair>& pairs, std::size_t copies) = 0;
    /// Answers what was loaded; the seconds that took.
    virtual double run() = 0;
    /// The answers of the last run, of the first copy.
    virtual std::vector<Found> found() const = 0;

private:
    Title title_;
};

using Candidates = std::vector<std::unique_ptr<Candidate>>;

/// Those for pairs of these classes: in float64, in float32, of libccd (none where it is not compiled in, or for
/// planes), and of a device.
void add_float64(test::Kind a, test::Kind b, Candidates& candidates);
void add_float32(test::Kind a, test::Kind b, Candidates& candidates);
void add_ccd(test::Kind a, test::Kind b, Candidates& candidates);
void add_device(Context& context, Candidates& candidates);

}  // namespace clinch::accuracy
