// Work that goes to another device when the one it was on fails.
#pragma once

#include <cstddef>
#include <exception>
#include <string>
#include <vector>

#include "src/device/context_impl.hpp"
#include "src/device/crew.hpp"

namespace clinch::detail {

/// Returns what `work()` does, which works on the context's primary device, or throws DeviceFault with that which did.
/// When a device fails in it (is_device_fault) and another one is left, it is retired, a line is added to `warnings`,
/// `drop()` gives back what was kept on it, and `work()` begins again; when none is left, or anything else is thrown,
/// that leaves.
template <class Work, class Drop>
auto with_failover(Context::Impl& context, std::vector<std::string>& warnings, const Work& work, const Drop& drop)
    -> decltype(work()) {
    for (;;) {
        DeviceFault fault{context.infos.empty() ? 0 : context.primary(), nullptr};
        try {
            return work();
        } catch (const DeviceFault& told) {
            fault = told;
        } catch (...) {
            fault.why = std::current_exception();
        }
        if (!is_device_fault(fault.why) || !context.retire(fault.device, message_of(fault.why)))
            std::rethrow_exception(fault.why);
        warnings.push_back(context.why_retired(fault.device));
        drop();
    }
}

}  // namespace clinch::detail
