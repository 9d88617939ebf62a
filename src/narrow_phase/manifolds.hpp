// Manifolds of contacts that are found already: cl/narrow_phase/manifold.clh on a device and on the host.
#pragma once

#include <cstdint>
#include <vector>

#include "clinch/scene.hpp"
#include "src/device/device.hpp"
#include "src/narrow_phase/narrow_scene.hpp"
#include "src/narrow_phase/slots.hpp"

namespace clinch::detail {

/// Most points a manifold has.
constexpr std::uint32_t most_points = 8;

/// A point of a manifold.
struct ManifoldPoint {
    double on_a[3];  ///< from a's position
    double distance, error;
    std::uint32_t feature;
};

/// The points of several contacts, one contact after the other, each by ascending features of which no two are equal.
struct ManifoldPoints {
    std::vector<std::uint32_t> firsts;  ///< of each contact its first point; one more at the end
    std::vector<ManifoldPoint> points;
};

/// Finds manifolds on a device.
class Manifolds {
public:
    explicit Manifolds(Device& device) : device_(device) {}

    /// Whether the device can do hulls such as these in 32 or 64 bits.
    bool can(const NarrowShapes& shapes, unsigned bits) const;
    /// Up to `wanted` (2 to most_points) points of each of the `count` contacts that slots.gather() left on the device,
    /// computed in 32 or 64 bits, for which the scene must be up to date. Waits.
    void find(const NarrowScene& scene, const Slots& slots, std::uint32_t count, bool with_rests, unsigned bits,
              std::uint32_t wanted, ManifoldPoints& out);

private:
    template <class Real>
    void read(std::uint32_t count, std::uint32_t wanted, ManifoldPoints& out);

    Device& device_;
    Kernel kernels_[2];  // for 32 and 64 bits
    Buffer points_, features_, counts_;
    std::uint64_t stride_ = 0;
};

/// The same on the host, in float64, of those answers that are hits.
void manifolds_on_host(const Scene& scene, const NarrowShapes& shapes, const std::vector<HostAnswer>& answers,
                       std::uint32_t wanted, ManifoldPoints& out);

}  // namespace clinch::detail
