// Generated scenes of bodies with shapes: what tests check, benchmarks time and `clinch scene` writes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "clinch/scene.hpp"

namespace clinch::scenes {

/// A kind of scene of bodies: its name and one line on what it is. Both strings are static.
struct BodyKind {
    const char* name;
    const char* what;
};

/// All kinds, in the order that help texts list them.
std::vector<BodyKind> body_kinds();

/// A scene of `count` bodies, at most 2^32 - 1. It depends on kind, count and seed alone: the same numbers, to the
/// bit, on every machine. An unknown kind is Error InvalidArgument, which lists the known ones.
Scene make_bodies(const std::string& kind, std::size_t count, std::uint64_t seed);

}  // namespace clinch::scenes
