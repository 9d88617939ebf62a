// Manifolds of contacts that are found already: cl/narrow_phase/manifold.clh and, of two boxes, manifold_boxes.clh, on
// a device and on the host.
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

/// The points of one contact.
struct FewPoints {
    ManifoldPoint points[most_points];
    std::uint32_t count = 0;
    std::uint32_t deepest = 0;  ///< has the contact's own distance and error, rounded perhaps
    bool is_witness = false;    ///< and its point, too
};

/// The points of contacts as a device left them, readable on the host while this lives.
struct DevicePoints {
    Mapping counts, features, points;
    std::uint64_t stride = 0;
    unsigned bits = 32;

    /// Those of contact i.
    FewPoints at(std::size_t i) const;
    std::uint32_t count(std::size_t i) const { return counts.as<std::uint32_t>()[i] & 255u; }

private:
    template <class Real>
    void read(std::size_t i, FewPoints& out) const;
};

/// Which contacts are of two boxes, for which there is a kernel of their own, and which are not: by number.
struct ContactKinds {
    std::vector<std::uint32_t> boxes, others;
};
ContactKinds kinds_of(const Scene& scene, const NarrowShapes& shapes, const std::uint32_t* a, const std::uint32_t* b,
                      std::uint32_t count);

/// Finds manifolds on a device.
class Manifolds {
public:
    explicit Manifolds(Device& device) : device_(device) {}

    /// Whether the device can do hulls such as these in 32 or 64 bits.
    bool can(const NarrowShapes& shapes, unsigned bits) const;
    /// Up to `wanted` (2 to most_points) points of each of the contacts that slots.gather() left on the device,
    /// computed in 32 or 64 bits, for which the scene must be up to date. Waits.
    void find(const NarrowScene& scene, const Slots& slots, const ContactKinds& kinds, bool with_rests, unsigned bits,
              std::uint32_t wanted, DevicePoints& out);

private:
    struct Part {
        const char* module;
        const char* kernel;
        const char* defines;
    };
    static constexpr Part parts[] = {{"narrow_phase/manifold_boxes", "find_box_manifolds", ""},
                                     {"narrow_phase/manifold", "find_manifolds", " -DPAIR_LANES=1"}};
    Kernel& kernel(std::size_t part, unsigned bits);
    std::uint32_t per_item(std::uint32_t count) const;

    Device& device_;
    Kernel kernels_[2][2];  // of each part, for 32 and 64 bits
    Buffer lists_[2], points_, features_, counts_;
    std::uint64_t stride_ = 0;
};

/// The same on the host, in float64, of those answers that are hits, in their order.
std::vector<FewPoints> manifolds_on_host(const Scene& scene, const NarrowShapes& shapes,
                                         const std::vector<HostAnswer>& answers, std::uint32_t wanted);

}  // namespace clinch::detail
