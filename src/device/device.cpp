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
    const cl_int status = clSetKernelArg(kernel_, index, size, value);
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

    Impl(const DeviceInfo& i, cl_device_id id, const ContextOptions& o)
        : info(i), options(o), device(id), cache(cache_folder(o), o.log) {
        report.info = i;
        report.opened = true;
        for (const std::string& quirk : i.quirks)
            if (o.log) o.log("device '" + i.name + "' has the quirk " + quirk);
    }

    static std::string cache_folder(const ContextOptions& o) {
        if (!o.use_kernel_cache) return {};
        return o.kernel_cache.empty() ? default_cache_folder() : o.kernel_cache;
    }

    const compute::program& program(const std::string& module, const std::string& defines);
    compute::program build(const std::string& module, const std::string& source, const std::string& build_options);
    std::optional<compute::program> load(const std::string& key, const std::string& build_options);
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

compute::program Device::Impl::build(const std::string& module, const std::string& source,
                                     const std::string& build_options) {
    return checked("building kernel module '" + module + "' for '" + info.name + "'", [&] {
        auto built = compute::program::create_with_source(source, context);
        // Built by the plain call: the wrapper prints the compiler's output in debug builds.
        const cl_device_id id = device.id();
        const cl_int status = clBuildProgram(built.get(), 1, &id, build_options.c_str(), nullptr, nullptr);
        if (status != CL_SUCCESS) {
            const std::string log = built.get_build_info<std::string>(CL_PROGRAM_BUILD_LOG, device);
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
    try {
        auto loaded = compute::program::create_with_binary(*binary, context);
        const cl_device_id id = device.id();
        check(clBuildProgram(loaded.get(), 1, &id, build_options.c_str(), nullptr, nullptr), "clBuildProgram");
        return loaded;
    } catch (const compute::opencl_error& error) {
        cache.discard(key, std::string("the driver refused it: ") + error.what());
    } catch (const Error& error) {
        cache.discard(key, std::string("the driver refused it: ") + error.what());
    }
    return {};
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
        cache.store(key,
                    checked("reading the binary of kernel module '" + module + "'", [&] { return program->binary(); }));
    }
    report.build_ms += watch.ms();
    return programs.emplace(module + ' ' + build_options, *program).first->second;
}

Device::Device(const DeviceInfo& info, cl_device_id id, const ContextOptions& options)
    : impl_(std::make_unique<Impl>(info, id, options)) {
    checked("opening device '" + info.name + "'", [&] {
        impl_->context = compute::context(impl_->device);
        impl_->queue = compute::command_queue(impl_->context, impl_->device);
    });
}

Device::Device(const DeviceInfo& info, cl_device_id id, cl_context context, cl_command_queue queue,
               const ContextOptions& options)
    : impl_(std::make_unique<Impl>(info, id, options)) {
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
    if (buffer.bytes() >= bytes && buffer.handle() != nullptr) return;
    buffer = Buffer();  // first, so that old and new need not fit side by side
    buffer = allocate(bytes, what);
}

void Device::write(const Buffer& buffer, const void* data, std::size_t bytes, std::size_t offset) {
    if (bytes == 0) return;
    if (bytes <= little) {
        const auto* first = static_cast<const std::byte*>(data);
        write_later(buffer, {first, first + bytes}, offset);
        return;
    }
    check(clEnqueueWriteBuffer(queue(), buffer.handle(), CL_TRUE, offset, bytes, data, 0, nullptr, nullptr),
          "clEnqueueWriteBuffer");
}

// The queue reads the data some time before the next command that is waited for is done.
void Device::write_later(const Buffer& buffer, std::vector<std::byte> data, std::size_t offset) {
    if (impl_->in_flight.size() >= most_in_flight) finish();
    impl_->in_flight.push_back(std::move(data));
    const std::vector<std::byte>& kept = impl_->in_flight.back();
    check(
        clEnqueueWriteBuffer(queue(), buffer.handle(), CL_FALSE, offset, kept.size(), kept.data(), 0, nullptr, nullptr),
        "clEnqueueWriteBuffer");
}

void Device::read(cl_mem memory, void* data, std::size_t bytes, std::size_t offset) {
    if (bytes == 0) return;
    check(clEnqueueReadBuffer(queue(), memory, CL_TRUE, offset, bytes, data, 0, nullptr, nullptr),
          "clEnqueueReadBuffer");
    impl_->in_flight.clear();
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
    check(clEnqueueFillBuffer(queue(), buffer.handle(), &zero, sizeof zero, 0, bytes, 0, nullptr, nullptr),
          "clEnqueueFillBuffer");
}

Mapping Device::map_for(cl_map_flags flags, const Buffer& buffer, std::size_t bytes) {
    Mapping mapping;
    if (bytes == 0) return mapping;
    cl_int status = CL_SUCCESS;
    void* pointer =
        clEnqueueMapBuffer(queue(), buffer.handle(), CL_TRUE, flags, 0, bytes, 0, nullptr, nullptr, &status);
    check(status, "clEnqueueMapBuffer");
    impl_->in_flight.clear();
    mapping.device_ = this;
    mapping.memory_ = buffer.handle();
    mapping.pointer_ = pointer;
    return mapping;
}

Mapping Device::map(const Buffer& buffer, std::size_t bytes) {
    return map_for(CL_MAP_READ, buffer, bytes);
}

Mapping Device::map_to_write(const Buffer& buffer, std::size_t bytes) {
    return map_for(CL_MAP_WRITE_INVALIDATE_REGION, buffer, bytes);
}

Kernel Device::kernel(const std::string& module, const std::string& name, const std::string& defines) {
    const compute::program& program = impl_->program(module, defines);
    Kernel kernel;
    kernel.kernel_ = checked("creating kernel '" + name + "' of module '" + module + "'", [&] {
        const compute::kernel created(program, name);
        clRetainKernel(created.get());
        return created.get();
    });
    kernel.name_ = name;
    return kernel;
}

void Device::add_module(const std::string& module, const std::string& source) {
    impl_->added_modules[module] = source;
}

void Device::launch(const Kernel& kernel, std::size_t groups, std::size_t group_size) {
    if (groups == 0) return;
    const std::size_t items = groups * group_size;
    const cl_int status =
        clEnqueueNDRangeKernel(queue(), kernel.handle(), 1, nullptr, &items, &group_size, 0, nullptr, nullptr);
    if (status != CL_SUCCESS)
        throw_opencl("launching kernel '" + kernel.name() + "' with " + std::to_string(items) +
                         " work-items in groups of " + std::to_string(group_size) + " on '" + impl_->info.name + "'",
                     status);
}

void Device::launch_items(const Kernel& kernel, std::size_t items) {
    launch(kernel, (items + 63) / 64, 64);
}

void Device::finish() {
    check(clFinish(queue()), "clFinish");
    impl_->in_flight.clear();
}

DeviceReport Device::report() const {
    DeviceReport report = impl_->report;
    report.bytes = impl_->account->bytes;
    report.peak_bytes = impl_->account->peak;
    return report;
}

}  // namespace clinch::detail
