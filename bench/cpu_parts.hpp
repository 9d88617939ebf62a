// The cores of this machine's CPU as devices of their own.
#pragma once

#include <cstddef>
#include <optional>

#include "clinch/context.hpp"
#include "src/device/context_impl.hpp"

namespace clinch::bench {

/// The CPU with the most compute units that PoCL offers; nothing if it offers none.
inline std::optional<DeviceInfo> largest_cpu() {
    std::optional<DeviceInfo> cpu;
    for (const DeviceInfo& info : list_devices())
        if (info.type == DeviceType::Cpu && info.platform == "Portable Computing Language" &&
            (!cpu || info.compute_units > cpu->compute_units))
            cpu = info;
    return cpu;
}

/// The first `devices` of its parts, each one compute unit; `devices` is 1 to whole.compute_units.
inline Context parts_of(const DeviceInfo& whole, std::size_t devices) {
    ContextOptions options;
    options.devices.indices = {whole.index};
    options.devices.sub_devices = whole.compute_units;
    Context context(options);
    Context::Impl& impl = context.impl();
    impl.infos.resize(devices);
    impl.ids.resize(devices);
    impl.id_owners.resize(devices);
    impl.devices.resize(devices);
    return context;
}

}  // namespace clinch::bench
