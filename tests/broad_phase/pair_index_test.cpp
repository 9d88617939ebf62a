// Pair numbers, decoded on the device, against a binary search in 128-bit integers.
#include <catch2/catch.hpp>
#include <utility>
#include <vector>

#include "clinch/aabb.hpp"
#include "tests/device/devices.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

__extension__ using Wide = unsigned __int128;

const char* const decode_source = R"(
#include "common/pair_index.clh"
kernel void decode(global const ulong* k, global const ulong* n, uint count, global uint2* pairs, global ulong* back) {
    uint i = get_global_id(0);
    if (i >= count) return;
    uint a, b;
    decode_pair(k[i], n[i], &a, &b);
    pairs[i] = (uint2)(a, b);
    back[i] = encode_pair(a, b, n[i]);
}
)";

// Number of the first pair of row a among n things.
Wide row_start(Wide a, Wide n) {
    return a * (2 * n - a - 1) / 2;
}

Pair decode(std::uint64_t k, std::uint64_t n) {
    std::uint64_t low = 0, high = n - 1;  // row_start(low) <= k < row_start(high)
    while (high - low > 1) {
        const std::uint64_t middle = low + (high - low) / 2;
        (row_start(middle, n) <= k ? low : high) = middle;
    }
    return {static_cast<std::uint32_t>(low),
            static_cast<std::uint32_t>(static_cast<std::uint64_t>(k - row_start(low, n)) + low + 1)};
}

struct Cases {
    std::vector<std::uint64_t> k, n;
    void add(std::uint64_t number, std::uint64_t things) {
        if (number >= things * (things - 1) / 2) return;
        k.push_back(number);
        n.push_back(things);
    }
};

// Random numbers, the ends of rows (where a root that is a hair off gives the wrong row), first and last.
Cases make_cases(std::size_t per_size, std::uint64_t seed) {
    test::Random random(seed);
    std::vector<std::uint64_t> sizes{2,         3,         4,        5,           64,          1000,       5000,
                                     92681,     92682,     92683,    100000,      1000000,     94906265,   94906266,
                                     134217728, 134217729, 1u << 31, 3000000000u, 4294967294u, 4294967295u};
    for (int i = 0; i < 20; ++i) sizes.push_back(2 + random.below(4294967294u));
    Cases cases;
    for (const std::uint64_t n : sizes) {
        const std::uint64_t last = n * (n - 1) / 2 - 1;
        for (const std::uint64_t k : {std::uint64_t{0}, std::uint64_t{1}, last / 2, last}) cases.add(k, n);
        if (last > 0) cases.add(last - 1, n);
        for (std::size_t i = 0; i < per_size; ++i) {
            cases.add(random.below(last + 1), n);
            const std::uint64_t row = random.below(n - 1);
            const auto start = static_cast<std::uint64_t>(row_start(row, n));
            cases.add(start, n);
            cases.add(start + 1, n);
            if (start > 0) cases.add(start - 1, n);
            const std::uint64_t late = n - 2 - random.below(std::min<std::uint64_t>(n - 1, 50));
            cases.add(static_cast<std::uint64_t>(row_start(late, n)), n);
        }
    }
    return cases;
}

void check_cases(const Cases& cases, const std::string& defines, detail::Device& device) {
    device.add_module("test/pair_index", decode_source);
    detail::Kernel kernel = device.kernel("test/pair_index", "decode", defines);
    const std::size_t count = cases.k.size();
    const detail::Buffer k = device.allocate(8 * count, "k"), n = device.allocate(8 * count, "n");
    const detail::Buffer pairs = device.allocate(8 * count, "pairs"), back = device.allocate(8 * count, "back");
    device.write(k, cases.k.data(), 8 * count);
    device.write(n, cases.n.data(), 8 * count);
    device.launch_items(kernel.args(k, n, static_cast<std::uint32_t>(count), pairs, back), count);
    std::vector<Pair> found(count);
    std::vector<std::uint64_t> numbers(count);
    device.read(pairs, found.data(), 8 * count);
    device.read(back, numbers.data(), 8 * count);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if (found[i] == decode(cases.k[i], cases.n[i]) && numbers[i] == cases.k[i]) continue;
        if (wrong++ == 0)
            WARN("first wrong: k " << cases.k[i] << " of n " << cases.n[i] << " gave " << found[i].a << ", "
                                   << found[i].b);
    }
    CHECK(wrong == 0);
}

void check_everywhere(std::size_t per_size, std::uint64_t seed) {
    INFO("seed " << seed);
    const Cases cases = make_cases(per_size, seed);
    const Context context = test::all_devices();
    for (std::size_t i = 0; i < context.devices().size(); ++i) {
        detail::Device& device = context.impl().open(i);
        check_cases(cases, "", device);
        if (device.info().fp64) check_cases(cases, "-DPAIR_INDEX_FP64=1", device);
    }
}

}  // namespace

TEST_CASE("pair numbers decode exactly, a few", "[device][small]") {
    check_everywhere(2, 21);
}

TEST_CASE("pair numbers decode exactly up to 2^32 - 1 things", "[device]") {
    check_everywhere(5000, 22);
}

TEST_CASE("every pair number of small sets decodes in order", "[device]") {
    Cases cases;
    for (std::uint64_t n = 2; n <= 130; ++n)
        for (std::uint64_t k = 0; k < n * (n - 1) / 2; ++k) cases.add(k, n);
    const Context context = test::all_devices();
    check_cases(cases, "", context.impl().open(0));
}
