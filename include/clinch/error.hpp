// The one exception type of the library.
#pragma once

#include <stdexcept>
#include <string>

namespace clinch {

/// What kind of failure an Error reports.
enum class ErrorCode {
    InvalidArgument,  ///< the call's own arguments are wrong: nothing was done
    NoDevice,         ///< no OpenCL device matches what was asked for
    BuildFailed,      ///< a kernel did not compile: see Error::build_log()
    OutOfMemory,      ///< host or device memory was short; the message names the size asked for
    DeviceFailed,     ///< an OpenCL call failed: see Error::opencl_status()
    LimitExceeded,    ///< a limit set by the caller was passed; the message names the true count
    FileFailed,       ///< a file of the library's own (a kernel source) could not be read
};

/// Short name of a code ("no device"), for logs. The string is static.
const char* to_string(ErrorCode code) noexcept;

/// Thrown by every function of the library that fails; nothing else leaves the library but
/// std::bad_alloc. The message is one sentence that names what failed, what was found and what is
/// accepted. After an Error the object that threw is as before the call, unless its comment says more.
class Error : public std::runtime_error {
public:
    /// `opencl_status` is the status of the failing OpenCL call (0: none was involved).
    Error(ErrorCode code, const std::string& message, int opencl_status = 0, std::string build_log = {});

    ErrorCode code() const noexcept { return code_; }
    /// Status of the OpenCL call that failed (CL_OUT_OF_RESOURCES is -5, ...); 0 if none did.
    int opencl_status() const noexcept { return opencl_status_; }
    /// The compiler's output when code() is BuildFailed, otherwise empty.
    const std::string& build_log() const noexcept { return build_log_; }

private:
    ErrorCode code_;
    int opencl_status_;
    std::string build_log_;
};

}  // namespace clinch
