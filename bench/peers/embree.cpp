// Embree: a BVH over the boxes as user geometry, collided with itself. Twice: with the usual build and with the
// fast one (Morton codes), which pays where there are few pairs.
#include <embree3/rtcore.h>
#include <tbb/global_control.h>

#include <stdexcept>
#include <string>
#include <type_traits>

#include "bench/peers/peer.hpp"
#include "bench/peers/thread_lists.hpp"

namespace clinch::peers {
namespace {

template <class Object, void (*release)(Object)>
struct Releaser {
    using pointer = Object;
    void operator()(Object object) const { release(object); }
};
template <class Object, void (*release)(Object)>
using Owned = std::unique_ptr<std::remove_pointer_t<Object>, Releaser<Object, release>>;

class Embree : public Peer {
public:
    Embree(unsigned threads, RTCBuildQuality quality)
        : limit_(tbb::global_control::max_allowed_parallelism, threads),
          device_(rtcNewDevice(("threads=" + std::to_string(threads)).c_str())),
          quality_(quality),
          lists_(threads) {
        if (!device_) throw std::runtime_error("Embree makes no device");
    }

    Lists run(View<const Aabb> boxes) override {
        boxes_ = boxes;
        lists_.clear();
        const Owned<RTCScene, rtcReleaseScene> scene(rtcNewScene(device_.get()));
        rtcSetSceneBuildQuality(scene.get(), quality_);
        const Owned<RTCGeometry, rtcReleaseGeometry> geometry(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_USER));
        rtcSetGeometryUserPrimitiveCount(geometry.get(), static_cast<unsigned>(boxes.size()));
        rtcSetGeometryUserData(geometry.get(), this);
        rtcSetGeometryBoundsFunction(geometry.get(), bounds, nullptr);
        rtcSetGeometryBuildQuality(geometry.get(), quality_);
        rtcCommitGeometry(geometry.get());
        rtcAttachGeometry(scene.get(), geometry.get());
        rtcCommitScene(scene.get());
        rtcCollide(scene.get(), scene.get(), collide, this);
        if (rtcGetDeviceError(device_.get()) != RTC_ERROR_NONE) throw std::runtime_error("Embree reports an error");
        return lists_.views();
    }

private:
    static void bounds(const RTCBoundsFunctionArguments* arguments) {
        const Aabb& box = static_cast<const Embree*>(arguments->geometryUserPtr)->boxes_[arguments->primID];
        RTCBounds& out = *arguments->bounds_o;
        out.lower_x = box.min[0], out.lower_y = box.min[1], out.lower_z = box.min[2];
        out.upper_x = box.max[0], out.upper_y = box.max[1], out.upper_z = box.max[2];
    }

    // Embree tests the boxes before it calls, and gives each pair both ways round.
    static void collide(void* self, RTCCollision* found, unsigned count) {
        Embree& peer = *static_cast<Embree*>(self);
        std::vector<Pair>& pairs = peer.lists_.mine();
        for (unsigned i = 0; i < count; ++i) {
            const std::uint32_t a = found[i].primID0, b = found[i].primID1;
            if (a < b) pairs.push_back({a, b});
        }
    }

    tbb::global_control limit_;
    Owned<RTCDevice, rtcReleaseDevice> device_;
    RTCBuildQuality quality_;
    View<const Aabb> boxes_;
    ThreadLists lists_;
};

}  // namespace

std::unique_ptr<Peer> make_embree(const Setup& setup) {
    return std::make_unique<Embree>(setup.threads, RTC_BUILD_QUALITY_MEDIUM);
}
std::unique_ptr<Peer> make_embree_fast_build(const Setup& setup) {
    return std::make_unique<Embree>(setup.threads, RTC_BUILD_QUALITY_LOW);
}

}  // namespace clinch::peers
