// Working on the caller's own OpenCL objects. The only public header that includes OpenCL.
#pragma once

#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

#include <cstddef>

#include "clinch/broad_phase.hpp"
#include "clinch/context.hpp"

namespace clinch {

/// A Context of one device that works in the caller's own OpenCL context and in-order queue, so that
/// the caller's buffers can be read. All three are retained, not owned: the caller may release them
/// at any time. A queue of another context or device is InvalidArgument.
/// `options.devices` is not looked at, nor is CLINCH_DEVICES.
Context make_context(cl_context context, cl_device_id device, cl_command_queue queue,
                     const ContextOptions& options = {});

/// As BroadPhase::find, with `count` boxes (Aabb, 24 bytes each) read from the caller's buffer, from
/// box number `first` on. `boxes` belongs to the OpenCL context given to make_context and is only
/// read, after what was enqueued before on that queue. A buffer that is too short, or of another
/// context, is InvalidArgument. The boxes are not copied to the host unless the algorithm runs there
/// or one of them must be reported as rejected.
View<const Pair> find_pairs(BroadPhase& broad_phase, cl_mem boxes, std::size_t count, std::size_t first = 0,
                            const FilterColumns& filters = {});

}  // namespace clinch
