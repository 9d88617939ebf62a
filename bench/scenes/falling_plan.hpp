// How each kind of falling scene begins, and where its bodies come to rest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/scenes/falling_ground.hpp"
#include "clinch/scene.hpp"

namespace clinch::scenes {

/// The time from a frame to the next, in seconds.
constexpr double frame_seconds = 1.0 / 60.0;
/// The highest body falls for about so many frames before it first strikes, whatever the count.
constexpr int fall_frames = 80;

/// A body that falls: how it starts, and where it lies in the end.
struct Faller {
    Vec3 position, velocity;  ///< at frame 0
    Quat rotation;
    Vec3 spin;  ///< radians a second about the world axes, until it first strikes
    Vec3 rest;
    Quat rest_rotation;
    double floor = 0.0;   ///< height of the layer of the pile that it lies on in the end
    double bounce = 0.0;  ///< speed after a strike as a part of that before
    std::uint32_t outline = 0;
};

/// A scene at frame 0, its static bodies first, and what moves the others.
struct FallPlan {
    Scene scene;
    std::size_t statics = 0;      ///< the fallers are the rows after these
    std::vector<Faller> fallers;  ///< in the order of rows; those that lie lowest in the end first
    std::vector<Outline> outlines;
    Ground ground;
    double gravity = 1.0;  ///< units a second squared, downward

    /// The lowest that a faller may be above (x, y): on the ground and on its layer, sunk into both a little, so that
    /// bodies at rest touch what they lie on.
    double lowest(const Faller& faller, const Quat& rotation, double x, double y) const;
};

/// Plans `count` bodies in all, at most 2^32 - 1. An unknown kind is Error InvalidArgument.
FallPlan plan_fall(const std::string& kind, std::size_t count, std::uint64_t seed);

}  // namespace clinch::scenes
