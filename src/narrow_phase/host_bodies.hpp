// Bodies of a scene as devices read them, made once on the host for all devices.
#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "clinch/scene.hpp"
#include "clinch/view.hpp"
#include "src/narrow_phase/narrow_shapes.hpp"
#include "src/scene/bounds.hpp"

namespace clinch::detail {

// As the structs of cl/narrow_phase/body.clh.
struct BodyFrame32 {
    float high[3], low[3], turn[9];
    std::uint32_t shape;
};
struct BodyFrame64 {
    double position[3], turn[9];
    std::uint32_t shape, unused;
};
static_assert(sizeof(BodyFrame32) == 64 && sizeof(BodyFrame64) == 104, "kernels read this layout");

/// A body that takes no part: class of a row that is not there or is rejected.
constexpr std::uint8_t no_class = 255;

/// The frame of a row that is in use, in float64.
BodyFrame64 frame_of(const Scene& scene, std::uint32_t row);

/// Any thread may ask, several at once; the first does what changed since the last call, on the host's threads, and the
/// others wait for it. Views are valid until the scene changes.
class HostBodies {
public:
    /// The class of each row, and its margin, rounded up.
    struct Classes {
        View<const std::uint8_t> classes;
        View<const float> margins;  ///< empty if no row has one
        std::uint64_t version = 0;  ///< another one after each change; never 0
    };
    Classes classes(const Scene& scene, const NarrowShapes& shapes);
    View<const BodyFrame32> frames32(const Scene& scene);
    View<const BodyFrame64> frames64(const Scene& scene);

private:
    template <class Frame>
    struct Frames {
        std::mutex mutex;
        RowTracker tracker;
        std::vector<Frame> rows;
    };
    template <class Frame>
    static View<const Frame> update(const Scene& scene, Frames<Frame>& frames);

    Frames<BodyFrame32> frames32_;
    Frames<BodyFrame64> frames64_;
    std::mutex mutex_;  // of what follows
    RowTracker tracker_;
    std::vector<std::uint8_t> classes_;
    std::vector<float> margins_;
    std::size_t with_margin_ = 0;  // rows
    std::uint64_t version_ = 0;
};

}  // namespace clinch::detail
