// Bodies and shapes of a scene as narrow-phase routines read them, kept on a device from call to call.
#pragma once

#include <cstdint>
#include <vector>

#include "clinch/scene.hpp"
#include "src/device/device.hpp"
#include "src/narrow_phase/host_bodies.hpp"
#include "src/narrow_phase/narrow_shapes.hpp"
#include "src/scene/bounds.hpp"

namespace clinch::detail {

/// All of it on a device: what a call asks for and what changed since is sent.
class NarrowScene {
public:
    /// Both must outlive this object.
    NarrowScene(Device& device, HostBodies& bodies) : device_(device), host_(bodies) {}

    /// Brings the float32 (`bits` 32) or float64 (64) frames and shapes on the device up to date with the scene.
    void update(const Scene& scene, const NarrowShapes& shapes, unsigned bits);
    /// Shapes are sent anew when they are next needed.
    void shapes_changed() noexcept { shapes32_.sent = shapes64_.sent = false; }
    /// Brings classes and margins up to date; the latter only if any row has one.
    void update_classes(const Scene& scene, const NarrowShapes& shapes);
    const Buffer& bodies(unsigned bits) const { return bits == 64 ? frames64_.buffer : frames32_.buffer; }
    const Buffer& shapes(unsigned bits) const { return shapes_of(bits).records; }
    const Buffer& vertices(unsigned bits) const { return shapes_of(bits).vertices; }
    /// Of hulls; empty without.
    const Buffer& faces(unsigned bits) const { return shapes_of(bits).faces; }
    const Buffer& corners(unsigned bits) const { return shapes_of(bits).corners; }
    const Buffer& classes() const { return classes_; }
    /// The same on the host, until the scene changes.
    View<const std::uint8_t> classes_on_host() const { return host_classes_; }
    /// One float a row, rounded up; only if has_margins().
    const Buffer& margins() const { return margins_; }
    bool has_margins() const noexcept { return has_margins_; }
    /// Everything is sent anew the next time.
    void forget();

private:
    template <class Frame>
    struct Frames {
        RowTracker tracker;
        Buffer buffer;
        std::vector<Frame> staging;
    };
    struct Shapes {
        Buffer records, vertices, faces, corners;
        bool sent = false;
    };
    const Shapes& shapes_of(unsigned bits) const noexcept { return bits == 64 ? shapes64_ : shapes32_; }
    template <class Frame>
    void send_frames(const Scene& scene, View<const Frame> all, Frames<Frame>& frames);
    template <class T>
    void send_shapes(const NarrowShapes& shapes, Shapes& to);
    template <class T>
    void send_faces(const NarrowShapes& shapes, Shapes& to);

    Device& device_;
    HostBodies& host_;
    Kernel place_kernel_;
    Frames<BodyFrame32> frames32_;
    Frames<BodyFrame64> frames64_;
    Shapes shapes32_, shapes64_;
    Buffer rows_, records_, classes_, margins_;
    std::uint64_t classes_version_ = 0;  // that were sent; 0: none
    View<const std::uint8_t> host_classes_;
    bool has_margins_ = false;
};

}  // namespace clinch::detail
