#include "bench/scenes/falling.hpp"

#include <algorithm>
#include <cmath>

namespace clinch::scenes {
namespace {

// Rebounds slower than this in frames of gravity end a body's motion: hops that no eye sees.
constexpr double least_rebound = 1.5;

Quat blend(const Quat& a, const Quat& b, double part) {
    // q and -q are the same rotation: the nearer one is taken, and the sum has a length.
    const double dot = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
    const double p = 1.0 - part, q = dot < 0.0 ? -part : part;
    return normalised({p * a.w + q * b.w, p * a.x + q * b.x, p * a.y + q * b.y, p * a.z + q * b.z});
}

void put(std::vector<double>& numbers, std::size_t i, const Vec3& v) {
    numbers[3 * i] = v.x;
    numbers[3 * i + 1] = v.y;
    numbers[3 * i + 2] = v.z;
}

}  // namespace

FallingBodies::FallingBodies(const std::string& kind, std::size_t count, std::uint64_t seed)
    : plan_(plan_fall(kind, count, seed)) {
    const std::size_t fallers = plan_.fallers.size();
    states_.resize(fallers);
    positions_.resize(3 * fallers);
    velocities_.resize(3 * fallers);
    spins_.resize(3 * fallers);
    rotations_.resize(4 * fallers);
    for (std::size_t i = 0; i < fallers; ++i) {
        const Faller& faller = plan_.fallers[i];
        states_[i].position = faller.position;
        states_[i].velocity = faller.velocity;
        states_[i].rotation = faller.rotation;
        states_[i].spin = faller.spin;
    }
    moving_ = fallers;
    move_scene();
}

void FallingBodies::step() {
    ++frame_;
    for (std::size_t i = 0; i < states_.size(); ++i) {
        State& state = states_[i];
        if (state.phase == Phase::Falling)
            fall(state, plan_.fallers[i]);
        else if (state.phase != Phase::Resting)
            fly(state, plan_.fallers[i]);
    }
    move_scene();
}

// A frame of free fall, with a strike if the body meets the ground or the layer of the pile that it belongs to.
void FallingBodies::fall(State& state, const Faller& faller) const {
    Vec3 &p = state.position, &v = state.velocity;
    v.z -= plan_.gravity * frame_seconds;
    p.x += v.x * frame_seconds;
    p.y += v.y * frame_seconds;
    p.z += v.z * frame_seconds;
    const double half = 0.5 * frame_seconds;
    const Quat turn{1.0, half * state.spin.x, half * state.spin.y, half * state.spin.z};
    state.rotation = normalised(product(turn, state.rotation));
    const double lowest = plan_.lowest(faller, state.rotation, p.x, p.y);
    if (p.z <= lowest) strike(state, faller, lowest);
}

// The first strike: off the bowl's wall, or upward off the layer, slower than before; then towards the place of rest.
void FallingBodies::strike(State& state, const Faller& faller, double lowest) const {
    Vec3 &p = state.position, &v = state.velocity;
    p.z = lowest;
    Vec3 normal{0.0, 0.0, 1.0};
    const double radius = plan_.ground.radius;
    const double on_layer = faller.floor + reach_below(plan_.outlines[faller.outline], state.rotation);
    if (radius > 0.0 && plan_.ground.height(plan_.outlines[faller.outline], state.rotation, p.x, p.y) > on_layer) {
        const Vec3 inward{-p.x, -p.y, radius - p.z};
        const double length = std::sqrt(inward.x * inward.x + inward.y * inward.y + inward.z * inward.z);
        if (length > 0.0) normal = {inward.x / length, inward.y / length, inward.z / length};
    }
    const double speed = v.x * normal.x + v.y * normal.y + v.z * normal.z;
    if (speed < 0.0) v.z -= (1.0 + faller.bounce) * speed * normal.z;
    aim(state, faller);
    state.launched = state.rotation;
    state.phase = Phase::Turning;
    // The mean rate of a turn from `launched` to `rest`, right to second order: twice the vector part of the quotient.
    const Quat back{state.launched.w, -state.launched.x, -state.launched.y, -state.launched.z};
    const Quat turn = product(faller.rest_rotation, back);
    const double rate = (turn.w < 0.0 ? -2.0 : 2.0) / (state.flight * frame_seconds);
    state.spin = {rate * turn.x, rate * turn.y, rate * turn.z};
}

// Starts a flight that ends on a frame, at the place of rest: from height z with vertical velocity v a body is at
// z + k dt v - g dt^2 k (k + 1) / 2 after k frames. The velocity changes as little as whole frames ask for.
void FallingBodies::aim(State& state, const Faller& faller) const {
    const double g = plan_.gravity, dt = frame_seconds;
    const double drop = state.position.z - faller.rest.z;
    const double start = std::max(state.velocity.z - 0.5 * g * dt, std::sqrt(std::max(0.0, -2.0 * g * drop)));
    const double seconds = (start + std::sqrt(std::max(0.0, start * start + 2.0 * g * drop))) / g;
    const double frames = std::max(1.0, std::ceil(seconds / dt));
    state.flight = state.left = static_cast<std::uint32_t>(frames);
    const double time = frames * dt;
    state.velocity = {(faller.rest.x - state.position.x) / time, (faller.rest.y - state.position.y) / time,
                      -drop / time + 0.5 * g * dt * (frames + 1.0)};
}

// A frame of an aimed flight. It stays in the bowl: its path lies above the straight line between two points of it.
void FallingBodies::fly(State& state, const Faller& faller) {
    Vec3 &p = state.position, &v = state.velocity;
    v.z -= plan_.gravity * frame_seconds;
    if (--state.left == 0) {
        land(state, faller);
        return;
    }
    p.x += v.x * frame_seconds;
    p.y += v.y * frame_seconds;
    p.z += v.z * frame_seconds;
    if (state.phase == Phase::Turning) {
        const double part = 1.0 - static_cast<double>(state.left) / static_cast<double>(state.flight);
        state.rotation = blend(state.launched, faller.rest_rotation, part);
        // An edge may reach lower half-way through a turn than at both ends.
        p.z = std::max(p.z, plan_.lowest(faller, state.rotation, p.x, p.y));
    }
}

// A strike at the place of rest, without a turn from now on: up again, or to rest when too slow.
void FallingBodies::land(State& state, const Faller& faller) {
    state.position = faller.rest;
    state.rotation = faller.rest_rotation;
    state.spin = {};
    const double rebound = -faller.bounce * state.velocity.z;
    if (rebound < least_rebound * plan_.gravity * frame_seconds) {
        state.velocity = {};
        state.phase = Phase::Resting;
        --moving_;
        return;
    }
    state.velocity = {0.0, 0.0, rebound};
    aim(state, faller);
    state.phase = Phase::Hopping;
}

void FallingBodies::move_scene() {
    const std::size_t fallers = states_.size(), first = plan_.statics;
    for (std::size_t i = 0; i < fallers; ++i) {
        const State& state = states_[i];
        put(positions_, i, state.position);
        put(velocities_, i, state.velocity);
        put(spins_, i, state.spin);
        rotations_[4 * i] = state.rotation.w;
        rotations_[4 * i + 1] = state.rotation.x;
        rotations_[4 * i + 2] = state.rotation.y;
        rotations_[4 * i + 3] = state.rotation.z;
    }
    plan_.scene.set_positions(positions_.data(), fallers, first);
    plan_.scene.set_rotations(rotations_.data(), fallers, first);
    plan_.scene.set_velocities(velocities_.data(), fallers, first);
    plan_.scene.set_angular_velocities(spins_.data(), fallers, first);
}

}  // namespace clinch::scenes
