#include "clinch/error.hpp"

#include <utility>

#include "src/device/opencl_error.hpp"

namespace clinch {

const char* to_string(ErrorCode code) noexcept {
    switch (code) {
        case ErrorCode::InvalidArgument:
            return "invalid argument";
        case ErrorCode::NoDevice:
            return "no device";
        case ErrorCode::BuildFailed:
            return "build failed";
        case ErrorCode::OutOfMemory:
            return "out of memory";
        case ErrorCode::DeviceFailed:
            return "device failed";
        case ErrorCode::LimitExceeded:
            return "limit exceeded";
        case ErrorCode::FileFailed:
            return "file failed";
    }
    return "unknown";
}

Error::Error(ErrorCode code, const std::string& message, int opencl_status, std::string build_log)
    : std::runtime_error(message), code_(code), opencl_status_(opencl_status), build_log_(std::move(build_log)) {}

namespace detail {

bool is_shortage(cl_int status) noexcept {
    return status == CL_MEM_OBJECT_ALLOCATION_FAILURE || status == CL_OUT_OF_RESOURCES ||
           status == CL_OUT_OF_HOST_MEMORY || status == CL_INVALID_BUFFER_SIZE;
}

void throw_opencl(const std::string& what, cl_int status) {
    throw Error(
        is_shortage(status) ? ErrorCode::OutOfMemory : ErrorCode::DeviceFailed,
        what + " failed: " + boost::compute::opencl_error::to_string(status) + " (" + std::to_string(status) + ")",
        status);
}

}  // namespace detail
}  // namespace clinch
