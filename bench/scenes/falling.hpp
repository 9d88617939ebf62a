// Scenes of bodies that fall and come to rest, frame by frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/scenes/bodies.hpp"
#include "bench/scenes/falling_plan.hpp"
#include "clinch/scene.hpp"

namespace clinch::scenes {

/// A kind of falling scene; frame 0 of it is the kind of body_kinds() of the same name.
struct FallingKind {
    BodyKind kind;
    std::size_t usual;  ///< number of bodies in all, static ones included, about as in [thesis 6]
};

/// All kinds, in the order that help texts list them.
std::vector<FallingKind> falling_kinds();

/// Bodies that fall from a loose cloud onto a plane, onto cones or into a bowl, bounce, and end in a loose pile in
/// which neighbours overlap a little. Each moves by its velocity, gravity and its bounces, which are damped, and aims
/// from its first strike on at its own place in the pile, until it lies there and does not move any more, after at
/// most 200 frames or so. This is no physics engine: bodies pass through one another on their way. Bodies stay
/// Dynamic when at rest; static ones never move. Frames depend on kind, count and seed alone: the same numbers, to the
/// bit, on every machine.
class FallingBodies {
public:
    /// Frame 0 of `count` bodies in all, static ones included, at most 2^32 - 1. An unknown kind is Error
    /// InvalidArgument, which lists the known ones.
    FallingBodies(const std::string& kind, std::size_t count, std::uint64_t seed);

    /// The bodies as they stand; the same scene in each frame. Velocities are those that brought each body here (that
    /// of turning, from the first strike on, as a mean over a bounce).
    const Scene& scene() const { return plan_.scene; }
    /// Goes on by one frame of frame_seconds. O(bodies and corners of those that have not struck twice).
    void step();
    /// Steps done.
    std::size_t frame() const { return frame_; }
    /// Bodies that are not at rest yet.
    std::size_t moving() const { return moving_; }

private:
    // Turning is the flight after the first strike: on it a body turns to how it lies in the end.
    enum class Phase : std::uint8_t { Falling, Turning, Hopping, Resting };
    struct State {
        Vec3 position, velocity, spin;
        Quat rotation, launched;             // launched: the rotation at the start of the flight
        std::uint32_t left = 0, flight = 0;  // frames of the flight still to go, and in all
        Phase phase = Phase::Falling;
    };

    void fall(State& state, const Faller& faller) const;
    void strike(State& state, const Faller& faller, double lowest) const;
    void aim(State& state, const Faller& faller) const;
    void fly(State& state, const Faller& faller);
    void land(State& state, const Faller& faller);
    void move_scene();

    FallPlan plan_;
    std::vector<State> states_;
    std::vector<double> positions_, rotations_, velocities_, spins_;  // as the scene's setters take them
    std::size_t frame_ = 0, moving_ = 0;
};

}  // namespace clinch::scenes
