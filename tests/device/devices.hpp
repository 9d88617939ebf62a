// Opened devices for tests of what runs on one.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "clinch/broad_phase.hpp"
#include "clinch/context.hpp"
#include "src/broad_phase/algorithm.hpp"
#include "src/device/context_impl.hpp"
#include "src/device/device.hpp"

namespace clinch::test {

/// Every device that the environment offers, opened.
inline Context all_devices() {
    Context context;
    for (std::size_t i = 0; i < context.devices().size(); ++i) context.impl().open(i);
    return context;
}

/// A context on device `i` alone whose lane-generic kernels are built for `lanes`.
inline Context with_lanes(std::uint32_t i, std::uint32_t lanes) {
    ContextOptions options;
    options.devices.indices = {i};
    Context context(options);
    context.impl().infos[0].lanes = lanes;
    return context;
}

/// A context of `count` devices: those that the environment offers, over and over, each opened as one of its own.
inline Context several(std::uint32_t count) {
    Context context;
    Context::Impl& impl = context.impl();
    const std::size_t there = impl.infos.size();
    for (std::size_t i = there; i < count; ++i) {
        const std::size_t as = i % there;
        impl.infos.push_back(impl.infos[as]);
        impl.ids.push_back(impl.ids[as]);
        impl.id_owners.push_back(impl.id_owners[as]);
    }
    impl.infos.resize(count);
    impl.ids.resize(count);
    impl.id_owners.resize(count);
    impl.devices.resize(count);
    return context;
}

/// A context that has device `i` several times, each opened as a device of its own.
inline Context several(std::uint32_t i, std::uint32_t times) {
    ContextOptions options;
    options.devices.indices = {i};
    Context context(options);
    Context::Impl& impl = context.impl();
    for (std::uint32_t k = 1; k < times; ++k) {
        impl.infos.push_back(impl.infos[0]);
        impl.ids.push_back(impl.ids[0]);
        impl.id_owners.push_back(impl.id_owners[0]);
        impl.devices.emplace_back();
    }
    return context;
}

/// Names of the broad-phase algorithms that run on a device: all but those that a quirk of it rules out.
inline std::vector<std::string> names_for(const DeviceInfo& device) {
    std::vector<std::string> names;
    for (const std::string& name : broad_phase_names())
        if (detail::runs_on(detail::algorithm_named(name), device)) names.push_back(name);
    return names;
}

}  // namespace clinch::test
