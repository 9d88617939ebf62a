// Sum, least or largest of many values on a device.
#pragma once

#include <cstdint>

#include "src/device/device.hpp"

namespace clinch::detail {

/// One operation on uints or floats. Keeps its kernels and work memory.
class Reduce {
public:
    enum class Operation {
        Sum,     ///< of uints modulo 2^32; of floats rounded in an order that depends on the device
        Least,   ///< NaN is passed over; of nothing: the largest uint, or infinity
        Largest  ///< NaN is passed over; of nothing: 0, or -infinity
    };
    enum class Value { Uint, Float };
    Reduce(Device& device, Operation operation, Value value) : device_(device), operation_(operation), value_(value) {}

    /// Enqueues the reduction of the first `n` values; the result is number 0 of result(). Cost: reads all once.
    void run(const Buffer& in, std::uint32_t n);
    /// The result on the device, for kernels to read.
    const Buffer& result() const noexcept { return result_; }
    /// The last result; waits for it. Of floats for Value::Float, of uints else.
    std::uint32_t as_uint();
    float as_float();

private:
    Device& device_;
    Operation operation_;
    Value value_;
    Kernel runs_kernel_, last_kernel_;
    Buffer parts_, result_;
};

}  // namespace clinch::detail
