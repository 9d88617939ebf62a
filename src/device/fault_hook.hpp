// Lets a test make any OpenCL call of a device fail, as drivers do that run out of something or lose their device.
#pragma once

#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

#include <functional>

namespace clinch::detail {

/// Asked before each OpenCL call that a device makes, with the call's name ("clEnqueueReadBuffer"; static). CL_SUCCESS:
/// the call is made. Any other status: it is not made, and that is what it returned. Null: nobody is asked, which
/// costs a branch a call. It must not throw, and is called on whatever thread works on the device.
///
/// Calls that give something back (clRelease..., clEnqueueUnmapMemObject, the clFinish of ~Device) are not asked for:
/// they stand in destructors, where a failure has no one to go to, and the library passes it over; leaving them out
/// would only make the leaks that tests look for.
using FaultHook = std::function<cl_int(const char* call)>;

/// What the hook says to a call of this name.
inline cl_int asked(const FaultHook& hook, const char* name) {
    return hook ? hook(name) : CL_SUCCESS;
}

/// Makes the call, unless the hook has it fail; returns its status.
template <class Call>
cl_int attempt(const FaultHook& hook, const char* name, const Call& call) {
    const cl_int status = asked(hook, name);
    return status == CL_SUCCESS ? call() : status;
}

}  // namespace clinch::detail
