// Pairs of planes with the bodies whose boxes reach into them.
#pragma once

#include <cstdint>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/scene.hpp"
#include "clinch/view.hpp"
#include "src/broad_phase/algorithm.hpp"
#include "src/broad_phase/inputs.hpp"
#include "src/device/device.hpp"

namespace clinch::detail {

/// The half-space normal . x <= offset of a body in world space, grown by the body's margin, in
/// float32; the rounding is covered by reaches_half_space.
struct WorldPlane {
    std::uint32_t body;
    float normal[3];
    float offset;
};

/// The planes of `rows` of a scene. Computed in float64.
std::vector<WorldPlane> world_planes(const Scene& scene, View<const std::uint32_t> rows);

/// Tests boxes against planes on a device or on the host, with the same answers.
class PlanePairs {
public:
    /// Pairs of `planes` with `boxes` that pass `filters`, ascending. Planes do not move. What was
    /// dropped is added to `counts`.
    const std::vector<Pair>& find(const std::vector<WorldPlane>& planes, View<const Aabb> boxes,
                                  const FilterInput& filters, FindCounts& counts);
    /// The same for `n` boxes on a device; waits for it.
    const std::vector<Pair>& find(Device& device, const std::vector<WorldPlane>& planes, const Buffer& boxes,
                                  std::uint32_t n, const FilterInput& filters, FindCounts& counts);

private:
    void expand(const std::vector<WorldPlane>& planes, const FilterInput& filters, FindCounts& counts);
    Kernel kernel_;
    Buffer planes_, words_;
    std::vector<std::uint32_t> host_words_;  // as the kernel writes them
    std::size_t words_per_plane_ = 0;
    std::vector<Pair> pairs_;
};

}  // namespace clinch::detail
