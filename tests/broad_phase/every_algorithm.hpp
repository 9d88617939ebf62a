// Runs a check with every row of the registry, so that a new algorithm is tested without a new test.
#pragma once

#include <catch2/catch.hpp>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "clinch/broad_phase.hpp"
#include "tests/broad_phase/oracle.hpp"
#include "tests/device/devices.hpp"
#include "tests/random.hpp"

namespace clinch::test {

inline bool same(View<const Pair> found, const std::vector<Pair>& expected) {
    return found.size() == expected.size() &&
           (expected.empty() || std::memcmp(found.data(), expected.data(), expected.size() * sizeof(Pair)) == 0);
}

/// Widths that lane-generic kernels are built for.
inline const std::vector<std::uint32_t> all_lanes{1, 4, 8, 16};
constexpr std::size_t default_scratch = std::size_t{64} << 20;

/// An algorithm on a device, its kernels built for a number of lanes.
struct Setting {
    std::string name;
    std::uint32_t device, lanes;
    std::string text() const {
        return "algorithm " + name + ", device " + std::to_string(device) + ", lanes " + std::to_string(lanes);
    }
};

/// Every algorithm on every device it runs on, for each of `lanes`; none: the device's own. Those of the host have
/// no lanes and need no device, so they come once; a device like an earlier one comes with the first of `lanes` alone.
inline std::vector<Setting> settings(const std::vector<std::uint32_t>& lanes) {
    std::vector<Setting> all;
    const std::vector<DeviceInfo> devices = list_devices();
    for (std::uint32_t d = 0; d < devices.size(); ++d) {
        bool seen = false;
        for (std::uint32_t e = 0; e < d; ++e) seen = seen || devices[e].name == devices[d].name;
        for (const std::string& name : names_for(devices[d])) {
            const bool on_host = !detail::algorithm_named(name).needs_device;
            if (on_host && d > 0) continue;
            const std::size_t widths = on_host || seen || lanes.empty() ? 1 : lanes.size();
            for (std::size_t i = 0; i < widths; ++i)
                all.push_back({name, d, lanes.empty() ? devices[d].lanes : lanes[i]});
        }
    }
    return all;
}

/// Runs `check` with a new BroadPhase of each setting.
inline void with_each(const std::vector<Setting>& settings, std::size_t scratch,
                      const std::function<void(BroadPhase&)>& check) {
    for (const Setting& setting : settings) {
        Context context = with_lanes(setting.device, setting.lanes);
        BroadPhaseOptions options;
        options.algorithm = setting.name;
        options.scratch_bytes = scratch;
        BroadPhase broad_phase(context, options);
        INFO(setting.text() << ", scratch " << scratch);
        check(broad_phase);
        CHECK(broad_phase.report().algorithm == setting.name);
    }
}

struct Filters {
    std::vector<std::uint32_t> group, mask;
    std::vector<Motion> motion;
    FilterColumns columns() const { return {group.data(), mask.data(), motion.data()}; }
};

inline Filters random_filters(std::size_t n, Random& random) {
    Filters f;
    for (std::size_t i = 0; i < n; ++i) {
        f.group.push_back(1u << random.below(4));
        f.mask.push_back(static_cast<std::uint32_t>(random.below(16)) | 0x80000000u);
        f.motion.push_back(static_cast<Motion>(random.below(4)));
    }
    return f;
}

inline void check_scene(BroadPhase& broad_phase, const std::vector<Aabb>& boxes, const FilterColumns& filters,
                        const std::vector<Pair>& expected) {
    const View<const Pair> found = broad_phase.find(boxes, filters);
    CHECK(same(found, expected));
    CHECK(broad_phase.report().pairs == expected.size());
    CHECK(broad_phase.report().bodies == boxes.size());
}

}  // namespace clinch::test
