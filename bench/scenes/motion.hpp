// Frames of a scene in which some boxes move.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "clinch/aabb.hpp"

namespace clinch::scenes {

/// Boxes of which a fixed part moves a little each frame, as in the kind `sparse-motion`. Each mover keeps its
/// direction and turns back where its centre would leave the bounds that all centres had at first, so that the scene
/// stays as dense as it was. Frames depend on boxes, fraction and seed alone: the same bytes on every machine.
class SparseMotion {
public:
    /// `boxes` are frame 0; the nearest whole number to `fraction` (0 to 1, else Error InvalidArgument) of them
    /// move, chosen with equal chance. An axis of side s moves up to s / 100 a frame, so that a
    /// cube moves 1 % of its side in a random direction.
    SparseMotion(std::vector<Aabb> boxes, double fraction, std::uint64_t seed);

    /// The boxes as they stand, valid until the end of this object; same order and place in memory in each frame.
    const std::vector<Aabb>& boxes() const { return boxes_; }
    /// Indices of those that move, ascending.
    const std::vector<std::uint32_t>& movers() const { return movers_; }
    /// Goes on by one frame. O(movers).
    void step();

private:
    using Vector = std::array<double, 3>;
    struct Mover {
        Vector centre, half, step;
    };

    std::vector<Aabb> boxes_;
    std::vector<std::uint32_t> movers_;
    std::vector<Mover> states_;  // in float64, so that steps far below a float's last bit add up
    Vector low_{}, high_{};
};

}  // namespace clinch::scenes
