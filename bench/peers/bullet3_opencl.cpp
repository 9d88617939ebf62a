// Bullet 3: its OpenCL broad phases, on the device that Boost.Compute takes by default. They lose pairs: their lists
// are cut off at a number given beforehand (here far more than there are pairs), the grid sees 256 bodies a
// cell and the 27 cells around a body of at most 3 units, the BVH's traversal has a stack of 128 entries.
// Bodies are kept from call to call and get the new boxes within it.
#include <Bullet3OpenCL/BroadphaseCollision/b3GpuGridBroadphase.h>
#include <Bullet3OpenCL/BroadphaseCollision/b3GpuParallelLinearBvhBroadphase.h>
#include <Bullet3OpenCL/BroadphaseCollision/b3GpuSapBroadphase.h>
#include <Bullet3OpenCL/Initialize/b3OpenCLUtils.h>

#include <algorithm>
#include <boost/compute/command_queue.hpp>
#include <boost/compute/system.hpp>
#include <limits>
#include <stdexcept>

#include "bench/peers/peer.hpp"

namespace clinch::peers {
namespace {

namespace compute = boost::compute;

class Bullet3 : public Peer {
public:
    Bullet3(b3GpuBroadphaseInterface::CreateFunc* make, const Setup& setup)
        : device_(find_device()),
          context_(device_),
          queue_(context_, device_),
          broad_phase_(make(context_.get(), device_.get(), queue_.get())),
          most_pairs_(static_cast<int>(
              std::min<std::uint64_t>(2 * setup.pairs + 100000, std::numeric_limits<int>::max() / 16))) {}

    Lists run(View<const Aabb> boxes) override {
        if (made_ != boxes.size()) make_bodies(boxes);
        b3AlignedObjectArray<b3SapAabb>& all = broad_phase_->getAllAabbsCPU();
        for (std::size_t i = 0; i < boxes.size(); ++i)
            for (int d = 0; d < 3; ++d) {
                all[static_cast<int>(i)].m_min[d] = boxes[i].min[d];
                all[static_cast<int>(i)].m_max[d] = boxes[i].max[d];
            }
        broad_phase_->writeAabbsToGpu();
        broad_phase_->calculateOverlappingPairs(most_pairs_);
        broad_phase_->getOverlappingPairsGPU().copyToHost(found_);
        pairs_.clear();
        for (int i = 0; i < found_.size(); ++i)
            pairs_.push_back({static_cast<std::uint32_t>(found_[i].x), static_cast<std::uint32_t>(found_[i].y)});
        return {pairs_};
    }

private:
    static compute::device find_device() {
        cl_int status = 0;
        if (b3OpenCLUtils_getNumPlatforms(&status) < 1 || status != CL_SUCCESS)  // loads OpenCL for Bullet, too
            throw std::runtime_error("Bullet finds no OpenCL");
        b3OpenCLUtils_setCachePath("/nonexistent");  // writes no file
        return compute::system::default_device();
    }

    void make_bodies(View<const Aabb> boxes) {
        if (made_ != 0) throw std::logic_error("the number of boxes has changed");
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const float *const low = boxes[i].min, *const high = boxes[i].max;
            broad_phase_->createProxy(b3MakeVector3(low[0], low[1], low[2]), b3MakeVector3(high[0], high[1], high[2]),
                                      static_cast<int>(i), 1, 1);
        }
        made_ = boxes.size();
    }

    compute::device device_;
    compute::context context_;
    compute::command_queue queue_;
    std::unique_ptr<b3GpuBroadphaseInterface> broad_phase_;
    int most_pairs_;
    std::size_t made_ = 0;
    b3AlignedObjectArray<b3Int4> found_;
    std::vector<Pair> pairs_;
};

}  // namespace

std::unique_ptr<Peer> make_bullet3_sap(const Setup& setup) {
    return std::make_unique<Bullet3>(b3GpuSapBroadphase::CreateFuncLocalMemory, setup);
}
std::unique_ptr<Peer> make_bullet3_grid(const Setup& setup) {
    return std::make_unique<Bullet3>(b3GpuGridBroadphase::CreateFunc, setup);
}
std::unique_ptr<Peer> make_bullet3_bvh(const Setup& setup) {
    return std::make_unique<Bullet3>(b3GpuParallelLinearBvhBroadphase::CreateFunc, setup);
}

}  // namespace clinch::peers
