#include "src/device/device.hpp"

#include <algorithm>
#include <boost/compute/buffer.hpp>
#include <boost/compute/command_queue.hpp>
#include <boost/compute/context.hpp>
#include <boost/compute/kernel.hpp>
#include <boost/compute/program.hpp>
#include <deque>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "src/device/kernel_sources.hpp"
#include "src/device/opencl_error.hpp"
#include "src/device/program_cache.hpp"
#include "src/device/stopwatch.hpp"

namespace clinch::detail {

namespace compute = boost::compute;

// Copying so many bytes costs less than waiting for the queue.
constexpr std::size_t little = std::size_t{1} << 16, most_in_flight = 64;

// --- memory ------------------------------------------------------------------------------------

void Buffer::release() noexcept {
    if (memory_ == nullptr) return;
    clReleaseMemObject(memory_);  // a status here has no one to go to
    account_->bytes -= bytes_;
    memory_ = nullptr;
    bytes_ = 0;
}

void Mapping::release() noexcept {
    if (pointer_ != nullptr) clEnqueueUnmapMemObject(device_->queue(), memory_, pointer_, 0, nullptr, nullptr);
    pointer_ = nullptr;
}

// --- kernels -----------------------------------------------------------------------------------

Kernel::~Kernel() {
    if (kernel_ != nullptr) clReleaseKernel(kernel_);
}

void Kernel::set_raw(cl_uint index, std::size_t size, const void* value) {
    const auto call = [&] { return clSetKernelArg(kernel_, index, size, value); };
    const cl_int status = fault_hook_ == nullptr ? call() : attempt(*fault_hook_, "clSetKernelArg", call);
    if (status != CL_SUCCESS)
        throw_opencl("clSetKernelArg of argument " + std::to_string(index) + " of kernel '" + name_ + "'", status);
}

// --- device ------------------------------------------------------------------------------------

struct Device::Impl {
    DeviceInfo info;
    ContextOptions options;
    compute::device device;
    compute::context context;
    compute::command_queue queue;
    ProgramCache cache;
    std::map<std::string, compute::program> programs;  // by module and defines
    std::map<std::string, std::string> added_modules;  // sources given by add_module
    std::shared_ptr<MemoryAccount> account = std::make_shared<MemoryAccount>();
    DeviceReport report;
    std::deque<std::vector<std::byte>> in_flight;  // host data of writes that nothing has waited for yet
    FaultHook fault_hook;
    std::optional<Slowdown> slowdown;

    Impl(const DeviceInfo& i, cl_device_id id, const ContextOptions& o, FaultHook hook, std::optional<Slowdown> slow)
        : info(i),
          options(o),
          device(id),
          cache(cache_folder(o), o.log),
          fault_hook(std::move(hook)),
          slowdown(std::move(slow)) {
        report.info = i;
        report.opened = true;
        for (const std::string& quirk : i.quirks)
            if (o.log) o.log("device '" + i.name + "' has the quirk " + quirk);
    }

    static std::string cache_folder(const ContextOptions& o) {
        if (!o.use_kernel_cache) return {};
        return o.kernel_cache.empty() ? default_cache_folder() : o.kernel_cache;
    }

    // Asks the hook before a call that the wrapper makes, and fails as the wrapper does.
    void ask(const char* call) const {
        const cl_int status = asked(fault_hook, call);
        if (status != CL_SUCCESS) throw compute::opencl_error(status);
    }
    // A command is given to the queue.
    void begin() {
        if (slowdown) slowdown->begin();
    }
    // All that was given to it is done.
    void end() {
        in_flight.clear();
        if (slowdown) slowdown->end();
    }
    // Makes a call, which is named in the error if it fails.
    template <class Call>
    void make(const char* name, const Call& call) const {
        check(attempt(fault_hook, name, call), name);
    }

    const compute::program& program(const std::string& module, const std::string& defines);
    compute::program build(const std::string& module, const std::string& source, const std::string& build_options);
    cl_int build(const compute::program& program, const std::string& build_options) const;
    std::string build_log(const compute::program& program) const;
    std::optional<compute::program> load(const std::string& key, const std::string& build_options);
    void keep(const std::string& module, const std::string& key, const compute::program& program) const;
};

namespace {

// What decides a binary, as the cache's key.
std::string cache_key(const DeviceInfo& info, const std::string& build_options, const std::string& source) {
    std::string key;
    for (const std::string& part : {info.platform, info.platform_version, info.name, info.vendor, info.version,
                                    info.driver_version, build_options, source})
        key += std::to_string(part.size()) + ':' + part + '\n';
    return key;
}

}  // namespace

// By the plain call: the wrapper prints the compiler's output in debug builds.
cl_int Device::Impl::build(const compute::program& program, const std::string& build_options) const {
    const cl_device_id id = device.id();
    return attempt(fault_hook, "clBuildProgram",
                   [&] { return clBuildProgram(program.get(), 1, &id, build_options.c_str(), nullptr, nullptr); });
}

// Empty where the driver does not give it: what failed is the build.
std::string Device::Impl::build_log(const compute::program& program) const {
    try {
        ask("clGetProgramBuildInfo");
        return program.get_build_info<std::string>(CL_PROGRAM_BUILD_LOG, device);
    } catch (const compute::opencl_error&) {
        return {};
    }
}

compute::program Device::Impl::build(const std::string& module, const std::string& source,
                                     const std::string& build_options) {
    const std::string purpose = "building kernel module '" + module + "' for '" + info.name + "'";
    return checked(purpose, [&] {
        ask("clCreateProgramWithSource");
        auto built = compute::program::create_with_source(source, context);
        const cl_int status = build(built, build_options);
        if (is_shortage(status)) throw_opencl(purpose, status);
        if (status != CL_SUCCESS) {
            const std::string log = build_log(built);
            throw Error(ErrorCode::BuildFailed,
                        "kernel module '" + module + "' does not compile for '" + info.name + "' (" + info.platform +
                            "); the compiler says: " + log.substr(0, log.find('\n')),
                        status, log);
        }
        return built;
    });
}

std::optional<compute::program> Device::Impl::load(const std::string& key, const std::string& build_options) {
    const auto binary = cache.load(key);
    if (!binary) return {};
    cl_int status = CL_SUCCESS;
    try {
        ask("clCreateProgramWithBinary");
        auto loaded = compute::program::create_with_binary(*binary, context);
        status = build(loaded, build_options);
        if (status == CL_SUCCESS) return loaded;
    } catch (const compute::opencl_error& error) {
        status = error.error_code();
    }
    // Where something was short, nothing is said of the entry.
    if (!is_shortage(status)) cache.discard(key, "the driver refused it: " + compute::opencl_error::to_string(status));
    return {};
}

// Puts a program into the cache. It works as well without.
void Device::Impl::keep(const std::string& module, const std::string& key, const compute::program& program) const {
    try {
        ask("clGetProgramInfo");
        cache.store(key, program.binary());
    } catch (const compute::opencl_error& error) {
        if (options.log)
            options.log("cannot keep kernel module '" + module + "': reading its binary failed: " + error.what());
    }
}

const compute::program& Device::Impl::program(const std::string& module, const std::string& defines) {
    const std::string build_options =
        "-cl-std=CL1.2 -DLANES=" + std::to_string(info.lanes) + (defines.empty() ? "" : " " + defines);
    const auto known = programs.find(module + ' ' + build_options);
    if (known != programs.end()) return known->second;

    const Stopwatch watch;
    const auto added = added_modules.find(module);
    const std::string source = added != added_modules.end() ? with_includes(added->second) : kernel_source(module);
    const std::string key = cache_key(info, build_options, source);
    std::optional<compute::program> program = load(key, build_options);
    if (program) {
        report.modules_cached.push_back(module);
    } else {
        program = build(module, source, build_options);
        report.modules_built.push_back(module);
        keep(module, key, *program);
    }
    report.build_ms += watch.ms();
    return programs.emplace(module + ' ' + build_options, *program).first->second;
}

Device::Device(const DeviceInfo& info, cl_device_id id, const ContextOptions& options, FaultHook fault_hook,
               std::optional<Slowdown> slowdown)
    : impl_(std::make_unique<Impl>(info, id, options, std::move(fault_hook), std::move(slowdown))) {
    checked("opening device '" + info.name + "'", [&] {
        impl_->ask("clCreateContext");
        impl_->context = compute::context(impl_->device);
        impl_->ask("clCreateCommandQueue");
        impl_->queue = compute::command_queue(impl_->context, impl_->device);
    });
}

Device::Device(const DeviceInfo& info, cl_device_id id, cl_context context, cl_command_queue queue,
               const ContextOptions& options)
    : impl_(std::make_unique<Impl>(info, id, options, FaultHook(), std::nullopt)) {
    impl_->context = compute::context(context);
    impl_->queue = compute::command_queue(queue);
}

Device::~Device() {
    if (impl_ != nullptr) clFinish(impl_->queue.get());
}

const DeviceInfo& Device::info() const noexcept {
    return impl_->info;
}
cl_context Device::context() const noexcept {
    return impl_->context.get();
}
cl_command_queue Device::queue() const noexcept {
    return impl_->queue.get();
}
std::size_t Device::group_size() const noexcept {
    return impl_->info.lanes > 1 ? 1 : 64;
}

Buffer Device::allocate(std::size_t bytes, const char* what) {
    bytes = std::max<std::size_t>(bytes, 1);
    const std::string purpose =
        std::string("allocating ") + std::to_string(bytes) + " bytes for " + what + " on '" + impl_->info.name + "'";
    if (bytes > impl_->info.max_allocation)
        throw Error(ErrorCode::OutOfMemory, purpose + " failed: one buffer may have " +
                                                std::to_string(impl_->info.max_allocation) + " bytes there");
    // Where host and device share memory, host memory from the start: mapping is then free.
    const cl_mem_flags place = impl_->info.unified_memory ? CL_MEM_ALLOC_HOST_PTR : 0;
    Buffer buffer;
    buffer.memory_ = checked(purpose, [&] {
        impl_->ask("clCreateBuffer");
        const compute::buffer memory(impl_->context, bytes, CL_MEM_READ_WRITE | place);
        clRetainMemObject(memory.get());
        return memory.get();
    });
    buffer.bytes_ = bytes;
    buffer.account_ = impl_->account;
    buffer.account_->bytes += bytes;
    buffer.account_->peak = std::max(buffer.account_->peak, buffer.account_->bytes);
    return buffer;
}

void Device::reserve(Buffer& buffer, std::size_t bytes, const char* what) {
    const bool own = buffer.account_ == impl_->account;  // not of a device that all was on before
    if (own && buffer.bytes() >= bytes && buffer.handle() != nullptr) return;
    // Fresh memory costs more than what is done with it: what grew once is given room to grow a little again.
    const std::size_t room = buffer.handle() != nullptr ? bytes / 8 : 0;
    buffer = Buffer();  // first, so that old and new need not fit side by side
    buffer = allocate(bytes + room <= impl_->info.max_allocation ? bytes + room : bytes, what);
}

void Device::write(const Buffer& buffer, const void* data, std::size_t bytes, std::size_t offset) {
    if (bytes == 0) return;
    if (bytes <= little) {
        const auto* first = static_cast<const std::byte*>(data);
        write_later(buffer, {first, first + bytes}, offset);
        return;
    }
    impl_->begin();
    impl_->make("clEnqueueWriteBuffer", [&] {
        return clEnqueueWriteBuffer(queue(), buffer.handle(), CL_TRUE, offset, bytes, data, 0, nullptr, nullptr);
    });
    impl_->end();
}

// The queue reads the data some time before the next command that is waited for is done.
void Device::write_later(const Buffer& buffer, std::vector<std::byte> data, std::size_t offset) {
    if (impl_->in_flight.size() >= most_in_flight) finish();
    impl_->in_flight.push_back(std::move(data));
    const std::vector<std::byte>& kept = impl_->in_flight.back();
    impl_->begin();
    impl_->make("clEnqueueWriteBuffer", [&] {
        return clEnqueueWriteBuffer(queue(), buffer.handle(), CL_FALSE, offset, kept.size(), kept.data(), 0, nullptr,
                                    nullptr);
    });
}

void Device::read(cl_mem memory, void* data, std::size_t bytes, std::size_t offset) {
    if (bytes == 0) return;
    impl_->begin();
    impl_->make("clEnqueueReadBuffer", [&] {
        return clEnqueueReadBuffer(queue(), memory, CL_TRUE, offset, bytes, data, 0, nullptr, nullptr);
    });
    impl_->end();
}

void Device::read(const Buffer& buffer, void* data, std::size_t bytes, std::size_t offset) {
    read(buffer.handle(), data, bytes, offset);
}

void Device::clear(const Buffer& buffer, std::size_t bytes) {
    if (bytes == 0) return;
    if (bytes <= little) {
        write_later(buffer, std::vector<std::byte>(bytes), 0);
        return;
    }
    const cl_uint zero = 0;
    impl_->begin();
    impl_->make("clEnqueueFillBuffer", [&] {
        return clEnqueueFillBuffer(queue(), buffer.handle(), &zero, sizeof zero, 0, bytes, 0, nullptr, nullptr);
    });
}

Mapping Device::map_for(cl_map_flags flags, const Buffer& buffer, std::size_t bytes, bool wait) {
    Mapping mapping;
    if (bytes == 0) return mapping;
    void* pointer = nullptr;
    impl_->begin();
    impl_->make("clEnqueueMapBuffer", [&] {
        cl_int status = CL_SUCCESS;
        pointer = clEnqueueMapBuffer(queue(), buffer.handle(), wait ? CL_TRUE : CL_FALSE, flags, 0, bytes, 0, nullptr,
                                     nullptr, &status);
        return status;
    });
    if (wait) impl_->end();
    mapping.device_ = this;
    mapping.memory_ = buffer.handle();
    mapping.pointer_ = pointer;
    return mapping;
}

Mapping Device::map(const Buffer& buffer, std::size_t bytes) {
    return map_for(CL_MAP_READ, buffer, bytes, true);
}

Mapping Device::map_later(const Buffer& buffer, std::size_t bytes) {
    return map_for(CL_MAP_READ, buffer, bytes, false);
}

Mapping Device::map_to_write(const Buffer& buffer, std::size_t bytes) {
    return map_for(CL_MAP_WRITE_INVALIDATE_REGION, buffer, bytes, true);
}

void Device::written(Mapping mapping) {
    if (mapping.pointer_ == nullptr) return;
    impl_->make("clEnqueueUnmapMemObject", [&] {
        return clEnqueueUnmapMemObject(queue(), mapping.memory_, std::exchange(mapping.pointer_, nullptr), 0, nullptr,
                                       nullptr);
    });
}

std::size_t Device::bytes_of(cl_mem memory, const char* what) const {
    std::size_t bytes = 0;
    cl_context of = nullptr;
    impl_->make("clGetMemObjectInfo",
                [&] { return clGetMemObjectInfo(memory, CL_MEM_SIZE, sizeof bytes, &bytes, nullptr); });
    impl_->make("clGetMemObjectInfo",
                [&] { return clGetMemObjectInfo(memory, CL_MEM_CONTEXT, sizeof of, &of, nullptr); });
    if (of != context())
        throw Error(ErrorCode::InvalidArgument, std::string("the buffer of ") + what +
                                                    " belongs to another OpenCL context than the device '" +
                                                    impl_->info.name + "'");
    return bytes;
}

Kernel Device::kernel(const std::string& module, const std::string& name, const std::string& defines) {
    const compute::program& program = impl_->program(module, defines);
    Kernel kernel;
    kernel.kernel_ = checked("creating kernel '" + name + "' of module '" + module + "'", [&] {
        impl_->ask("clCreateKernel");
        const compute::kernel created(program, name);
        clRetainKernel(created.get());
        return created.get();
    });
    kernel.name_ = name;
    if (impl_->fault_hook) kernel.fault_hook_ = &impl_->fault_hook;
    return kernel;
}

void Device::add_module(const std::string& module, const std::string& source) {
    impl_->added_modules[module] = source;
}

void Device::launch(const Kernel& kernel, std::size_t groups, std::size_t group_size) {
    if (groups == 0) return;
    const std::size_t items = groups * group_size;
    impl_->begin();
    const cl_int status = attempt(impl_->fault_hook, "clEnqueueNDRangeKernel", [&] {
        return clEnqueueNDRangeKernel(queue(), kernel.handle(), 1, nullptr, &items, &group_size, 0, nullptr, nullptr);
    });
    if (status != CL_SUCCESS)
        throw_opencl("launching kernel '" + kernel.name() + "' with " + std::to_string(items) +
                         " work-items in groups of " + std::to_string(group_size) + " on '" + impl_->info.name + "'",
                     status);
}

void Device::launch_items(const Kernel& kernel, std::size_t items) {
    launch(kernel, (items + 63) / 64, 64);
}

void Device::finish() {
    impl_->make("clFinish", [&] { return clFinish(queue()); });
    impl_->end();
}

DeviceReport Device::report() const {
    DeviceReport report = impl_->report;
    report.bytes = impl_->account->bytes;
    report.peak_bytes = impl_->account->peak;
    return report;
}

}  // namespace clinch::detail
