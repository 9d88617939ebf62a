// Turns failures of the OpenCL wrapper into clinch::Error. For src/device only.
#pragma once

#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

#include <boost/compute/exception/opencl_error.hpp>
#include <string>

namespace clinch::detail {

/// Whether the status says that memory, or what else a call needs, was short.
bool is_shortage(cl_int status) noexcept;

/// Throws Error for a failed OpenCL call: "<what> failed: <name of status> (<number>)".
[[noreturn]] void throw_opencl(const std::string& what, cl_int status);

/// Throws unless `status` is CL_SUCCESS.
inline void check(cl_int status, const char* what) {
    if (status != CL_SUCCESS) throw_opencl(what, status);
}

/// Runs `call`; an OpenCL failure inside leaves as Error that names `what`.
template <class Call>
auto checked(const std::string& what, Call&& call) -> decltype(call()) {
    try {
        return call();
    } catch (const boost::compute::opencl_error& error) {
        throw_opencl(what, error.error_code());
    }
}

}  // namespace clinch::detail
