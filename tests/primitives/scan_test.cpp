#include "src/primitives/scan.hpp"

#include <catch2/catch.hpp>
#include <numeric>
#include <vector>

#include "tests/device/devices.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

void check_scan(detail::Device& device, detail::Scan& scan, const std::vector<std::uint32_t>& in) {
    const auto n = static_cast<std::uint32_t>(in.size());
    const detail::Buffer from = device.allocate(4 * in.size(), "in");
    const detail::Buffer to = device.allocate(4 * in.size(), "out");
    device.write(from, in.data(), 4 * in.size());
    scan.exclusive(from, n, to);
    std::vector<std::uint32_t> out(in.size()), expected(in.size());
    device.read(to, out.data(), 4 * in.size());
    std::exclusive_scan(in.begin(), in.end(), expected.begin(), 0u);
    CHECK(out == expected);
    CHECK(scan.total() == std::accumulate(in.begin(), in.end(), 0u));
}

void check_sizes(const std::vector<std::size_t>& sizes, std::uint64_t seed) {
    INFO("seed " << seed);
    const Context context = test::all_devices();
    for (std::size_t i = 0; i < context.devices().size(); ++i) {
        detail::Device& device = context.impl().open(i);
        detail::Scan scan(device);
        test::Random random(seed);
        for (const std::size_t n : sizes) {
            INFO("n " << n);
            std::vector<std::uint32_t> in(n);
            for (std::uint32_t& value : in) value = static_cast<std::uint32_t>(random.below(7));
            check_scan(device, scan, in);
            std::fill(in.begin(), in.end(), 0u);
            if (n > 0) in[n / 2] = 0xffffffffu;  // the largest sum there may be
            check_scan(device, scan, in);
        }
    }
}

}  // namespace

TEST_CASE("scan of small arrays", "[device][small]") {
    check_sizes({0, 1, 2, 63, 255, 256, 257, 700}, 11);
}

TEST_CASE("scan of large arrays", "[device]") {
    check_sizes({5000, 65536, 1000003, 0, 9}, 12);
}
