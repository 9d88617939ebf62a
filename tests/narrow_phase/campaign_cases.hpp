// Pairs of bodies by the batch, random and hostile, of two classes of shapes.
#pragma once

#include <cstdint>
#include <vector>

#include "clinch/scene.hpp"
#include "tests/narrow_phase/campaign_oracle.hpp"

namespace clinch::test::campaign {

/// How a pair came about.
enum class Kin {
    none,
    mirrored,  // the pair before, its bodies in the other order
    moved,     // the pair before, both bodies turned and moved some 1e6 of their sizes away
};

struct CampaignPair {
    CampaignBody a, b;
    Real3 hint;  // the direction it was laid out along
    Kin kin = Kin::none;
};

/// The shapes of a batch and its pairs.
struct Batch {
    std::vector<Form> forms;
    std::vector<CampaignPair> pairs;
};

/// `count` pairs of classes a and b, in either order: bodies of sizes 1 (now and then 1e-310 to 1e20), unequal up to
/// 1e5, aspects up to 1e4, slivers, flat hulls, hulls of repeated and coplanar points, capsules without length;
/// concentric, on each other's axes, identical, parallel at angles of 0 or 1e-9 to 1e-2, laid to touch exactly, or
/// with a gap or depth of 1e-12 to 10 sizes, along faces' normals, edges' common perpendiculars, to corners; near the
/// world's origin or 1e3 to 1e6 sizes away. The same for the same seed and number of the batch.
Batch batch_of(std::size_t a, std::size_t b, std::size_t count, std::uint64_t seed, std::uint64_t number);

/// Row 2 i and 2 i + 1 are the bodies of pair i, each with this margin.
Scene scene_of(const Batch& batch, double margin);

}  // namespace clinch::test::campaign
