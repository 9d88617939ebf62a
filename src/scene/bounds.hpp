// The bounds stage: the box of every row of a scene, kept from step to step. A box holds the exact shape grown
// by the body's margin; cl/common/bounds.clh states the method and its error bound.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/scene.hpp"
#include "clinch/view.hpp"
#include "src/device/device.hpp"
#include "src/scene/bounds_shim.hpp"

namespace clinch::detail {

/// Which rows of a scene changed since they were last seen. Sees another scene when its identity differs.
class RowTracker {
public:
    /// The rows to look at: all of them when `all` or when this scene was not the one seen last, else the
    /// changed ones; ascending. The view is valid until the next call.
    View<const std::uint32_t> changed(const Scene& scene, bool all);
    /// True when this scene is the one seen last.
    bool knows(const Scene& scene) const;
    /// The scene as it stands has been dealt with.
    void seen(const Scene& scene);
    /// Nothing has been seen.
    void forget() noexcept { identity_.reset(); }

private:
    std::shared_ptr<const int> identity_;
    std::uint64_t version_ = 0;
    std::vector<std::uint32_t> rows_;
};

/// Writes the records of `rows` to `out`, in their order. Several threads above a few thousand rows.
void gather_records(const Scene& scene, View<const std::uint32_t> rows, BodyRecord* out);

/// Boxes in the memory of one device.
class DeviceBounds {
public:
    /// `device` must outlive this object. Allocates and builds nothing yet.
    explicit DeviceBounds(Device& device) : device_(device) {}

    /// Sends what changed in this scene since the last call: records of changed rows (moved, added,
    /// removed, rejected), and shapes. Returns the number of rows sent; all rows when the scene is another
    /// one or has outgrown the buffer. Throws Error; the next call then sends everything.
    std::size_t upload(const Scene& scene);
    /// The rows that the last upload sent, ascending; valid until the next.
    View<const std::uint32_t> sent() const noexcept { return sent_; }
    /// Enqueues the kernel for the rows sent by the last upload. No rows, or a second time: nothing.
    /// Throws Error; the next upload then sends everything.
    void compute();
    /// One Aabb a row of the scene (the buffer may be longer); NaN for rows without a box. Valid until the next
    /// upload.
    const Buffer& boxes() const { return boxes_; }
    Device& device() const noexcept { return device_; }

private:
    void send_rows(const Scene& scene, View<const std::uint32_t> rows);
    void send_shapes(const Scene& scene);
    bool grow(Buffer& buffer, std::size_t bytes, const char* what);

    Device& device_;
    Kernel kernel_;
    RowTracker tracker_;
    Buffer records_, shapes_, vertices_, boxes_;
    std::vector<BodyRecord> staging_;
    std::uint64_t shapes_sent_ = 0;  // scene version up to which shapes were sent; 0: none
    View<const std::uint32_t> sent_;
    std::size_t pending_ = 0;  // rows sent whose boxes are not computed yet
};

/// The same boxes, byte for byte, computed on the host.
class HostBounds {
public:
    /// Brings the boxes up to date; returns the number of rows looked at. Several threads above a few
    /// thousand rows.
    std::size_t update(const Scene& scene);
    /// One box a row, NaN for rows without one. Valid until the next update.
    View<const Aabb> boxes() const { return boxes_; }

private:
    RowTracker tracker_;
    std::vector<BodyRecord> records_;
    std::vector<Aabb> boxes_;
};

}  // namespace clinch::detail
