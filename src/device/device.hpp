// One opened OpenCL device: its memory, kernels and in-order queue. The rest of the library talks
// to OpenCL through this file alone; the wrapper behind it (Boost.Compute) is seen in this folder only.
// Every OpenCL failure leaves here as clinch::Error with the call, what it was for, and the status.
#pragma once

#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clinch/context.hpp"
#include "clinch/device.hpp"
#include "clinch/error.hpp"
#include "src/device/fault_hook.hpp"
#include "src/device/slowdown.hpp"

namespace clinch::detail {

class Device;

/// Owns device memory; gives it back to the device's account when it ends. Empty when default-made.
class Buffer {
public:
    Buffer() = default;
    ~Buffer() { release(); }
    Buffer(Buffer&& other) noexcept { swap(other); }
    Buffer& operator=(Buffer&& other) noexcept {
        Buffer(std::move(other)).swap(*this);
        return *this;
    }
    cl_mem handle() const noexcept { return memory_; }
    std::size_t bytes() const noexcept { return bytes_; }

private:
    friend class Device;
    void release() noexcept;
    void swap(Buffer& other) noexcept {
        std::swap(memory_, other.memory_);
        std::swap(bytes_, other.bytes_);
        std::swap(account_, other.account_);
    }
    cl_mem memory_ = nullptr;
    std::size_t bytes_ = 0;
    std::shared_ptr<struct MemoryAccount> account_;
};

/// Bytes held on a device now and at most; outlives the device while buffers do.
struct MemoryAccount {
    std::uint64_t bytes = 0;
    std::uint64_t peak = 0;
};

/// Work-group local memory of `bytes` as a kernel argument.
struct LocalMemory {
    std::size_t bytes;
};

/// A kernel with its arguments. Cheap to copy a handle of; one user sets arguments and launches.
class Kernel {
public:
    Kernel() = default;
    ~Kernel();
    Kernel(Kernel&& other) noexcept { swap(other); }
    Kernel& operator=(Kernel&& other) noexcept {
        Kernel(std::move(other)).swap(*this);
        return *this;
    }
    explicit operator bool() const noexcept { return kernel_ != nullptr; }

    /// Sets all arguments in order: Buffer, cl_mem, LocalMemory, or a value of the kernel's own type
    /// (uint32_t for uint, ...).
    template <class... A>
    Kernel& args(const A&... values) {
        cl_uint index = 0;
        (set(index++, values), ...);
        return *this;
    }
    /// Sets arguments from number `index` on; the others keep what they have.
    template <class... A>
    void args_from(cl_uint index, const A&... values) {
        (set(index++, values), ...);
    }
    cl_kernel handle() const noexcept { return kernel_; }
    const std::string& name() const noexcept { return name_; }

private:
    friend class Device;
    void swap(Kernel& other) noexcept {
        std::swap(kernel_, other.kernel_);
        std::swap(name_, other.name_);
        std::swap(fault_hook_, other.fault_hook_);
    }
    void set_raw(cl_uint index, std::size_t size, const void* value);
    void set(cl_uint index, const Buffer& buffer) { set(index, buffer.handle()); }
    void set(cl_uint index, cl_mem memory) { set_raw(index, sizeof(cl_mem), &memory); }
    void set(cl_uint index, LocalMemory local) { set_raw(index, local.bytes, nullptr); }
    template <class T>
    void set(cl_uint index, const T& value) {
        static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>, "a kernel argument is a plain value");
        set_raw(index, sizeof value, &value);
    }
    cl_kernel kernel_ = nullptr;
    std::string name_;
    const FaultHook* fault_hook_ = nullptr;  // the device's
};

/// Device memory made readable, or writable, on the host: mapped where they share memory, else copied by the
/// driver. Unmapped at its end.
class Mapping {
public:
    Mapping() = default;
    ~Mapping() { release(); }
    Mapping(Mapping&& other) noexcept { swap(other); }
    Mapping& operator=(Mapping&& other) noexcept {
        Mapping(std::move(other)).swap(*this);
        return *this;
    }
    template <class T>
    const T* as() const noexcept {
        return static_cast<const T*>(pointer_);
    }
    /// Of a mapping to write.
    template <class T>
    T* to() const noexcept {
        return static_cast<T*>(pointer_);
    }
    void release() noexcept;

private:
    friend class Device;
    void swap(Mapping& other) noexcept {
        std::swap(device_, other.device_);
        std::swap(memory_, other.memory_);
        std::swap(pointer_, other.pointer_);
    }
    Device* device_ = nullptr;
    cl_mem memory_ = nullptr;
    void* pointer_ = nullptr;
};

/// An opened device. Commands run in order; only the functions that say so wait.
class Device {
public:
    /// Opens `info`'s device `id` in a context and queue of its own, or in the caller's. `fault_hook` and `slowdown`
    /// are for tests and benchmarks.
    Device(const DeviceInfo& info, cl_device_id id, const ContextOptions& options, FaultHook fault_hook = {},
           std::optional<Slowdown> slowdown = {});
    Device(const DeviceInfo& info, cl_device_id id, cl_context context, cl_command_queue queue,
           const ContextOptions& options);
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    const DeviceInfo& info() const noexcept;
    cl_context context() const noexcept;
    cl_command_queue queue() const noexcept;
    /// Work-items a group has in kernels that fit any size: 1 where a work-item is a whole core's
    /// vector unit (lanes > 1), 64 elsewhere.
    std::size_t group_size() const noexcept;

    /// Memory of `bytes` (0 is taken as 1). `what` names its use in the error when memory is short.
    Buffer allocate(std::size_t bytes, const char* what);
    /// Makes `buffer` at least `bytes` long; when it grows its content is lost, and it is given an eighth more.
    void reserve(Buffer& buffer, std::size_t bytes, const char* what);
    /// Copies host memory in; the host memory may be reused on return. Little of it does not wait.
    void write(const Buffer& buffer, const void* data, std::size_t bytes, std::size_t offset = 0);
    /// Copies out to host memory; waits for it.
    void read(const Buffer& buffer, void* data, std::size_t bytes, std::size_t offset = 0);
    void read(cl_mem memory, void* data, std::size_t bytes, std::size_t offset = 0);
    /// Sets the first `bytes` (a multiple of 4) to zero.
    void clear(const Buffer& buffer, std::size_t bytes);
    /// Readable host memory of the first `bytes`; waits for it. `buffer` must outlive the mapping.
    Mapping map(const Buffer& buffer, std::size_t bytes);
    /// The same without waiting: it may be read when a later command has been waited for.
    Mapping map_later(const Buffer& buffer, std::size_t bytes);
    /// Host memory for the first `bytes`, of which all must be written before the mapping ends.
    Mapping map_to_write(const Buffer& buffer, std::size_t bytes);
    /// Ends such a mapping: what was written is the buffer's from here on.
    void written(Mapping mapping);
    /// Size of memory that is not the library's own. It must be of this device's context, else InvalidArgument, whose
    /// message says `what` it is.
    std::size_t bytes_of(cl_mem memory, const char* what) const;

    /// The kernel `name` of the module `module` ("broad_phase/brute" is cl/broad_phase/brute.cl),
    /// built for this device on first use with `defines` ("-DNAME=1 ...") on top of LANES.
    Kernel kernel(const std::string& module, const std::string& name, const std::string& defines = {});
    /// Makes `source` (which may include files of cl/) the module `module`, for kernels that are not
    /// part of the library: tests and benchmark baselines.
    void add_module(const std::string& module, const std::string& source);
    /// Enqueues `groups` work-groups of `group_size` items. No groups: nothing is enqueued.
    void launch(const Kernel& kernel, std::size_t groups, std::size_t group_size);
    /// Enqueues at least `items` work-items in groups of 64; the kernel itself leaves out those past its end.
    void launch_items(const Kernel& kernel, std::size_t items);
    /// Waits until all that was enqueued is done.
    void finish();

    DeviceReport report() const;

private:
    friend class Mapping;
    Mapping map_for(cl_map_flags flags, const Buffer& buffer, std::size_t bytes, bool wait);
    void write_later(const Buffer& buffer, std::vector<std::byte> data, std::size_t offset);
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace clinch::detail
