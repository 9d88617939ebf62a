// One device's half of the narrow phase: what it keeps of the scene, its kernels, and what it did.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "src/device/device.hpp"
#include "src/device/stopwatch.hpp"
#include "src/narrow_phase/narrow_call.hpp"
#include "src/narrow_phase/narrow_scene.hpp"

namespace clinch::detail {

/// What one device did of a call.
struct NarrowShare {
    struct Bucket {
        std::uint64_t pairs = 0, again = 0;
        const char* numbers = "";
    };
    std::uint64_t pairs = 0, chunks = 0;
    std::array<Bucket, 32> buckets;  ///< by row of the matrix
    NarrowTimes ms;                  ///< `total`: until its last chunk was done
    double build_ms = 0.0;           ///< of that, building kernels, which the next call need not
    /// Adds it to a report that has a bucket for each row of the matrix.
    void add_to(NarrowReport& report) const;
};

/// Everything of a narrow phase that belongs to one device but for the chunks themselves: see ChunkWork. One thread at
/// a time.
class NarrowWorker {
public:
    /// Both must outlive this object. Sends and builds nothing yet.
    NarrowWorker(Device& device, NarrowSettings& settings)
        : device_(device), settings_(settings), scene_(device, settings.bodies) {}
    NarrowWorker(const NarrowWorker&) = delete;
    NarrowWorker& operator=(const NarrowWorker&) = delete;

    /// A call begins: nothing is done of it yet. Nothing is sent before the first chunk.
    void start_call();
    /// Brings what every chunk of the call needs up to date on the device; at its first chunk.
    void begin(const NarrowCall& call);
    bool began() const noexcept { return began_; }
    /// Calls `work` and adds how long it took to the share.
    template <class Work>
    void timed(const Work& work) {
        const Stopwatch watch;
        const double built = device_.report().build_ms;
        work();
        share_.build_ms += device_.report().build_ms - built;
        share_.ms.total += watch.ms();
    }
    void shapes_changed() noexcept { scene_.shapes_changed(); }
    /// After an error: everything is sent anew.
    void forget() { scene_.forget(); }

    Device& device() const noexcept { return device_; }
    const DeviceInfo& info() const noexcept { return device_.info(); }
    NarrowSettings& settings() const noexcept { return settings_; }
    NarrowScene& scene() noexcept { return scene_; }
    NarrowShare& share() noexcept { return share_; }

    /// Whether bucket k is done in float32 first.
    bool in_float32(const NarrowCall& call, std::size_t k) const;
    /// Whether bucket k has iterations that start from corners, and this device does them.
    bool starts_warm(const NarrowCall& call, std::size_t k) const;
    /// The kernel of bucket k for numbers of so many bits; built at its first use.
    Kernel& kernel(const NarrowCall& call, std::size_t k, unsigned bits);
    /// Waits for the device if stages are measured.
    void stage_done() const {
        if (settings_.options.measure_stages) device_.finish();
    }

private:
    Device& device_;
    NarrowSettings& settings_;
    NarrowScene scene_;
    // Of a bucket, in 32 and 64 bits: for contacts, and for only which pairs touch; from nothing, and warm.
    std::array<std::array<std::array<std::array<Kernel, 2>, 2>, 2>, 32> kernels_;
    NarrowShare share_;
    bool began_ = false;
};

}  // namespace clinch::detail
