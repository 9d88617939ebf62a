// Opened devices for tests of what runs on one.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "clinch/context.hpp"
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

}  // namespace clinch::test
