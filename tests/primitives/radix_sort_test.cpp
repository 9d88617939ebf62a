#include "src/primitives/radix_sort.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>
#include <vector>

#include "tests/device/devices.hpp"
#include "tests/random.hpp"

using namespace clinch;

namespace {

// Device memory for keys and payloads of any case: memory that comes again larger makes the simulator report it.
struct Room {
    detail::Buffer keys, payload;
    Room(detail::Device& device, std::size_t n)
        : keys(device.allocate(n * sizeof(std::uint64_t), "keys")),
          payload(device.allocate(n * sizeof(std::uint64_t), "payload")) {}
};

// Sorts the keys by their lowest `bits` bits and compares with a stable sort; the payload is either numbered or given.
template <class Key>
void check_keys(detail::Device& device, detail::RadixSort& sort, Room& room, const std::vector<Key>& keys,
                unsigned bits, bool number, test::Random& random) {
    const auto n = static_cast<std::uint32_t>(keys.size());
    INFO("n " << n << ", bits " << bits << ", bits a key " << 8 * sizeof(Key) << ", numbered " << number);
    std::vector<Key> sorted(n);
    std::vector<std::uint32_t> payload(n), moved(n), order(n);
    std::iota(payload.begin(), payload.end(), 0u);
    if (!number)
        for (std::uint32_t& value : payload) value = static_cast<std::uint32_t>(random.bits());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });

    detail::Buffer &k = room.keys, &p = room.payload;
    device.write(k, keys.data(), n * sizeof(Key));
    if (!number) device.write(p, payload.data(), n * sizeof(std::uint32_t));
    sort.sort(k, p, n, bits, number);
    device.read(k, sorted.data(), n * sizeof(Key));
    device.read(p, moved.data(), n * sizeof(std::uint32_t));
    std::size_t wrong = 0;
    for (std::uint32_t i = 0; i < n; ++i)
        wrong += sorted[i] == keys[order[i]] && moved[i] == payload[order[i]] ? 0U : 1U;
    CHECK(wrong == 0);
}

template <class Key>
void check_sort(detail::Device& device, detail::RadixSort& sort, Room& room, std::uint32_t n, bool number,
                test::Random& random) {
    std::vector<Key> keys(n);
    for (const unsigned bits : {1u, 5u, 9u, 31u, 8 * static_cast<unsigned>(sizeof(Key))}) {
        for (Key& key : keys) key = static_cast<Key>(random.bits() >> (64 - bits));
        check_keys(device, sort, room, keys, bits, number, random);
    }
    std::fill(keys.begin(), keys.end(), static_cast<Key>(random.bits()));
    check_keys(device, sort, room, keys, 8 * static_cast<unsigned>(sizeof(Key)), number, random);
    for (std::uint32_t i = 0; i < n; ++i) keys[i] = static_cast<Key>(~Key{0} - i);  // in reverse
    check_keys(device, sort, room, keys, 8 * static_cast<unsigned>(sizeof(Key)), number, random);
}

void check_sizes(const std::vector<std::uint32_t>& sizes, const std::vector<std::uint32_t>& lanes, std::uint64_t seed) {
    INFO("seed " << seed);
    test::Random random(seed);
    for (std::uint32_t i = 0; i < list_devices().size(); ++i)
        for (const std::uint32_t lane_count : lanes) {  // one lane: many short runs, as on a GPU
            const Context context = test::with_lanes(i, lane_count);
            detail::Device& device = context.impl().open(0);
            detail::RadixSort sort32(device), sort64(device, detail::RadixSort::Key::Bits64);
            Room room(device, *std::max_element(sizes.begin(), sizes.end()));
            for (const std::uint32_t n : sizes)
                for (const bool number : {true, false}) {
                    check_sort<std::uint32_t>(device, sort32, room, n, number, random);
                    check_sort<std::uint64_t>(device, sort64, room, n, number, random);
                }
        }
}

}  // namespace

TEST_CASE("radix sort of small arrays", "[device][small]") {
    check_sizes({300, 2, 1, 0}, {1}, 51);
}

TEST_CASE("radix sort of large arrays", "[device]") {
    check_sizes({0, 1, 2, 255, 5000, 70001}, {1, 16}, 52);
}

TEST_CASE("radix sort whose runs are longer than some devices' loops", "[device]") {
    test::Random random(57);
    for (std::uint32_t i = 0; i < list_devices().size(); ++i) {
        const Context context = test::with_lanes(i, 16);
        detail::RadixSort sort(context.impl().open(0));
        Room room(context.impl().open(0), 600001);
        std::vector<std::uint32_t> keys(600001);
        for (std::uint32_t& key : keys) key = static_cast<std::uint32_t>(random.bits());
        check_keys(context.impl().open(0), sort, room, keys, 32, true, random);
    }
}
