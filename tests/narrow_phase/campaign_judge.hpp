// What answers of the narrow phase break of their promises, by certificates.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "clinch/contact.hpp"
#include "tests/narrow_phase/campaign_cases.hpp"

namespace clinch::test::campaign {

/// Kinds of broken promises.
enum Fault : std::size_t {
    lost,         // not reported though within the margins, or surely overlapping
    false_hit,    // reported though its own answer says that it is not to be
    not_finite,   //
    not_unit,     // the normal
    not_joined,   // on_b is not on_a + distance * normal
    too_near,     // distance + error is below what a direction proves
    too_far,      // distance - error is above what points of both bodies, or all axes, prove
    bad_normal,   // the normal proves less than distance - error
    bad_witness,  // a point is off its body, or not the farthest along the normal
    not_alike,    // the mirrored or moved pair answers otherwise
    fault_count
};
const char* name_of(Fault fault);

/// How the narrow phase was asked.
enum class Asked { fast, certain, exact };
constexpr std::array<Asked, 3> all_asked{Asked::fast, Asked::certain, Asked::exact};
/// Its precision: 0, 0.5, 1.
double precision_of(Asked asked);

/// What was found of many answers. Errors are those that certificates prove, so at most the true ones.
struct Tally {
    std::uint64_t answers = 0;
    std::uint64_t proved = 0;  // of those, promises that certificates prove to be kept; the others were not refuted
    std::array<std::uint64_t, fault_count> faults{};
    double used = 0;     // greatest share of the promised error that was needed
    double off = 0;      // greatest error, of the pair's size
    double promise = 0;  // greatest promised error, of the pair's size
    double regret = 0;  // of overlapping pairs: what another direction parts them more by, of the depth or 1e-3 of size
    double witness = 0;  // how far points are off their bodies, or short of the farthest, of the size
    std::array<std::string, fault_count> examples{};  // one of each fault
    void add(const Tally& other);
    std::uint64_t broken() const;
};

/// A pair's three answers; null where there was none. Certain ones were asked for without margins.
struct Answers {
    std::array<const Contact*, 3> by{};
    const Contact*& operator[](Asked asked) { return by[static_cast<std::size_t>(asked)]; }
    const Contact* operator[](Asked asked) const { return by[static_cast<std::size_t>(asked)]; }
};

using Tallies = std::array<Tally, 3>;

/// `before`: the answers of the pair before, of which this may be kin.
void judge(const CampaignPair& pair, const Answers& answers, const Answers& before, bool thorough, Random& random,
           Tallies& tallies);

/// The numbers that make the pair.
std::string text_of(const CampaignPair& pair);

}  // namespace clinch::test::campaign
