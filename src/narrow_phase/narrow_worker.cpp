#include "src/narrow_phase/narrow_worker.hpp"

#include <limits>
#include <string>

#include "src/device/quirks.hpp"
#include "src/narrow_phase/matrix.hpp"

namespace clinch::detail {

void NarrowShare::add_to(NarrowReport& report) const {
    for (std::size_t k = 0; k < report.buckets.size(); ++k) {
        BucketReport& bucket = report.buckets[k];
        bucket.pairs += buckets[k].pairs;
        bucket.again += buckets[k].again;
        if (buckets[k].pairs > 0) bucket.numbers = buckets[k].numbers;
    }
    report.ms.upload += ms.upload;
    report.ms.buckets += ms.buckets;
    report.ms.routines += ms.routines;
    report.ms.manifolds += ms.manifolds;
    report.ms.gather += ms.gather;
}

void NarrowWorker::start_call() {
    share_ = NarrowShare{};
    began_ = false;
}

void NarrowWorker::begin(const NarrowCall& call) {
    const Stopwatch upload;
    began_ = true;
    const NarrowShapes& shapes = settings_.shapes;
    scene_.update_classes(call.scene, shapes);
    if (!settings_.options.tolerance) scene_.update(call.scene, shapes, settings_.level == Level::Exact ? 64 : 32);
    stage_done();
    share_.ms.upload += upload.ms();
}

bool NarrowWorker::in_float32(const NarrowCall& call, std::size_t k) const {
    const bool any_loops = most_loop_iterations(info()) == std::numeric_limits<std::uint32_t>::max();
    return (settings_.level == Level::Fast || settings_.plans.of(k, call.only_pairs).passes != Passes::float64) &&
           (matrix()[k].lanes || any_loops);
}

bool NarrowWorker::starts_warm(const NarrowCall& call, std::size_t k) const {
    const MatrixRow& row = matrix()[k];
    return call.warm != nullptr && !row.lanes && row.a != plane_class && (in_float32(call, k) || info().fp64);
}

Kernel& NarrowWorker::kernel(const NarrowCall& call, std::size_t k, unsigned bits) {
    const bool warm = starts_warm(call, k);
    Kernel& kernel = kernels_[k][bits == 64 ? 1 : 0][call.only_pairs ? 1 : 0][warm ? 1 : 0];
    if (kernel) return kernel;
    const MatrixRow& row = matrix()[k];
    const std::string defines = std::string(row.defines) + number_defines(info(), bits) +
                                (row.lanes ? "" : " -DPAIR_LANES=1") + (call.only_pairs ? " -DONLY_TOUCHING" : "") +
                                (warm ? " -DWARM_START" : "");
    kernel = device_.kernel(row.module, "touch_pairs", defines);
    return kernel;
}

}  // namespace clinch::detail
