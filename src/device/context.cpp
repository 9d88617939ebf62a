#include "clinch/context.hpp"

#include <memory>
#include <mutex>
#include <optional>
#include <tuple>
#include <utility>

#include "clinch/interop/opencl.hpp"
#include "src/device/context_impl.hpp"
#include "src/device/discovery.hpp"
#include "src/device/kernel_sources.hpp"
#include "src/device/opencl_error.hpp"

namespace clinch {

detail::Device& Context::Impl::open(std::size_t i) {
    if (devices[i] == nullptr) {
        detail::FaultHook hook;
        if (fault_hook) hook = [ask = fault_hook, i](const char* call) { return ask(i, call); };
        std::optional<detail::Slowdown> slowdown;
        if (i < slowed.size()) slowdown.emplace(slowed[i]);
        devices[i] = std::make_unique<detail::Device>(infos[i], ids[i], options, std::move(hook), std::move(slowdown));
    }
    return *devices[i];
}

std::size_t Context::Impl::primary() const {
    if (infos.empty())
        throw Error(ErrorCode::InvalidArgument,
                    "this needs an OpenCL device, but the context was made for the host alone");
    const auto rank = [&](std::size_t i) {
        return std::make_tuple(in_use(i), infos[i].type == DeviceType::Gpu, infos[i].compute_units * infos[i].lanes);
    };
    std::size_t best = 0;
    for (std::size_t i = 1; i < infos.size(); ++i)
        if (rank(i) > rank(best)) best = i;
    return best;
}

bool Context::Impl::retire(std::size_t i, const std::string& why) {
    if (i < infos.size() && !in_use(i)) return true;
    if (infos.empty() || crew().size() < 2) return false;
    retired.resize(infos.size());
    retired[i] = why.empty() ? "it failed" : why;
    if (options.log) options.log(why_retired(i));
    return true;
}

std::string Context::Impl::why_retired(std::size_t i) const {
    return "device " + std::to_string(i) + " ('" + infos[i].name + "') failed and is not used any more: " + retired[i];
}

std::vector<std::size_t> Context::Impl::crew() const {
    std::vector<std::size_t> crew;
    if (infos.empty()) return crew;
    const std::size_t first = primary();
    crew.push_back(first);
    for (std::size_t i = 0; i < infos.size(); ++i)
        if (i != first && in_use(i)) crew.push_back(i);
    return crew;
}

namespace {

// Devices work on threads of their own: what they have to say is said one after the other.
ContextOptions with_orderly_log(ContextOptions options) {
    if (!options.log) return options;
    options.log = [log = std::move(options.log), mutex = std::make_shared<std::mutex>()](const std::string& line) {
        const std::lock_guard<std::mutex> lock(*mutex);
        log(line);
    };
    return options;
}

}  // namespace

Context::Context(const ContextOptions& options) : impl_(std::make_unique<Impl>()) {
    impl_->options = with_orderly_log(options);
    for (detail::FoundDevice& found : detail::choose_devices(options.devices)) {
        impl_->infos.push_back(std::move(found.info));
        impl_->ids.push_back(found.id);
        impl_->id_owners.push_back(std::move(found.owner));
        impl_->devices.emplace_back();
    }
}

Context::Context(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
Context::~Context() = default;
Context::Context(Context&& other) noexcept = default;
Context& Context::operator=(Context&& other) noexcept = default;

Context Context::host_only() {
    return Context(std::make_unique<Impl>());
}

const std::vector<DeviceInfo>& Context::devices() const noexcept {
    return impl_->infos;
}

std::vector<DeviceReport> Context::report() const {
    std::vector<DeviceReport> reports;
    for (std::size_t i = 0; i < impl_->infos.size(); ++i) {
        if (impl_->devices[i] != nullptr) {
            reports.push_back(impl_->devices[i]->report());
        } else {
            reports.emplace_back();
            reports.back().info = impl_->infos[i];
        }
    }
    return reports;
}

std::size_t Context::module_count() const noexcept {
    return detail::kernel_module_count();
}

Context make_context(cl_context context, cl_device_id device, cl_command_queue queue, const ContextOptions& options) {
    cl_context queue_context = nullptr;
    cl_device_id queue_device = nullptr;
    cl_command_queue_properties properties = 0;
    detail::check(clGetCommandQueueInfo(queue, CL_QUEUE_CONTEXT, sizeof queue_context, &queue_context, nullptr),
                  "clGetCommandQueueInfo");
    detail::check(clGetCommandQueueInfo(queue, CL_QUEUE_DEVICE, sizeof queue_device, &queue_device, nullptr),
                  "clGetCommandQueueInfo");
    detail::check(clGetCommandQueueInfo(queue, CL_QUEUE_PROPERTIES, sizeof properties, &properties, nullptr),
                  "clGetCommandQueueInfo");
    if (queue_context != context || queue_device != device)
        throw Error(ErrorCode::InvalidArgument,
                    "the command queue belongs to another OpenCL context or device than those given");
    if ((properties & CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE) != 0)
        throw Error(ErrorCode::InvalidArgument, "the command queue runs out of order; an in-order queue is needed");
    auto impl = std::make_unique<Context::Impl>();
    impl->options = with_orderly_log(options);
    impl->infos.push_back(detail::checked("describing the caller's device", [&] { return detail::describe(device); }));
    impl->ids.push_back(device);
    impl->id_owners.emplace_back();
    impl->devices.push_back(std::make_unique<detail::Device>(impl->infos[0], device, context, queue, impl->options));
    return Context(std::move(impl));
}

}  // namespace clinch
