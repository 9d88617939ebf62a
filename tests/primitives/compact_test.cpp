#include "src/primitives/compact.hpp"

#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

#include "tests/device/devices.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

constexpr std::uint32_t untouched = 0xabcdef01u;

// One in `one_in` entries is flagged (0: none).
void check_compact(detail::Device& device, detail::Compact& compact, std::size_t n, std::uint64_t one_in,
                   test::Random& random) {
    INFO("n " << n << ", flagged one in " << one_in);
    std::vector<std::uint32_t> flags(n, 0), values(n), kept_values, kept_numbers;
    for (std::size_t i = 0; i < n; ++i) {
        values[i] = static_cast<std::uint32_t>(random.bits());
        if (one_in == 0 || random.below(one_in) != 0) continue;
        flags[i] = static_cast<std::uint32_t>(random.bits()) | 1u;  // any number but 0 is a flag
        kept_values.push_back(values[i]);
        kept_numbers.push_back(static_cast<std::uint32_t>(i));
    }
    const std::size_t bytes = n * sizeof(std::uint32_t);
    const detail::Buffer f = device.allocate(bytes, "flags"), v = device.allocate(bytes, "values"),
                         out = device.allocate(bytes + 4, "out");
    device.write(f, flags.data(), bytes);
    device.write(v, values.data(), bytes);
    const auto check = [&](std::vector<std::uint32_t> expected) {
        CHECK(compact.count() == expected.size());
        expected.push_back(untouched);  // nothing is written behind the last
        std::vector<std::uint32_t> found(expected.size());
        device.read(out, found.data(), found.size() * sizeof found[0]);
        CHECK(found == expected);
    };
    const auto clear = [&] {
        const std::vector<std::uint32_t> none(n + 1, untouched);
        device.write(out, none.data(), none.size() * sizeof none[0]);
    };
    clear();
    compact.values(f, v, static_cast<std::uint32_t>(n), out);
    check(kept_values);
    clear();
    compact.numbers(f, static_cast<std::uint32_t>(n), out);
    check(kept_numbers);
}

void check_sizes(const std::vector<std::size_t>& sizes, const std::vector<std::uint32_t>& lanes, std::uint64_t seed) {
    INFO("seed " << seed);
    test::Random random(seed);
    for (std::uint32_t i = 0; i < list_devices().size(); ++i)
        for (const std::uint32_t lane_count : lanes) {
            INFO("lanes " << lane_count);
            const Context context = test::with_lanes(i, lane_count);
            detail::Device& device = context.impl().open(0);
            detail::Compact compact(device);
            for (const std::size_t n : sizes)
                for (const std::uint64_t one_in : {0u, 1u, 2u, 50u}) check_compact(device, compact, n, one_in, random);
        }
}

}  // namespace

TEST_CASE("compaction of few entries", "[device][small]") {
    check_sizes({0, 1, 2, 255, 256, 257, 600}, {1}, 65);
}

TEST_CASE("compaction of few entries, in vectors", "[device][vectors]") {
    check_sizes({0, 1, 15, 16, 17, 600}, {4, 16}, 66);
}

TEST_CASE("compaction of many entries", "[device]") {
    check_sizes({5000, 12289, 0, 3, 1500007}, {1, 16}, 67);
}
