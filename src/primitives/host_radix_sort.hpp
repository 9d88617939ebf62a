// Sorting by digits of integer keys, on one thread of the host.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace clinch::detail {

/// Sorts `items` ascending by the lowest `bits` (0 to 64) of key_of(item), which have nothing above them; items of one
/// key stay in their order. `spare` has room for as many, is overwritten, and may not overlap. Radix sort from the
/// lowest digit on [Knuth, The Art of Computer Programming 3, 5.2.5]: one read for each digit of at most 11 bits, and a
/// read and a write for each in which keys differ.
template <class Item, class KeyOf>
void host_radix_sort(Item* items, Item* spare, std::size_t count, unsigned bits, const KeyOf& key_of) {
    constexpr unsigned most_digit_bits = 11;
    if (count < 2 || bits == 0) return;
    const unsigned digits = (bits + most_digit_bits - 1) / most_digit_bits, digit_bits = (bits + digits - 1) / digits;
    const std::size_t values = std::size_t{1} << digit_bits;
    std::array<std::size_t, std::size_t{1} << most_digit_bits> places;
    Item *from = items, *to = spare;
    for (unsigned digit = 0; digit < digits; ++digit) {
        const auto value_of = [&](const Item& item) {
            return static_cast<std::size_t>(key_of(item) >> (digit * digit_bits)) & (values - 1);
        };
        std::fill_n(places.begin(), values, std::size_t{0});
        for (std::size_t i = 0; i < count; ++i) ++places[value_of(from[i])];
        if (places[value_of(from[0])] == count) continue;  // all alike
        std::size_t at = 0;
        for (std::size_t value = 0; value < values; ++value) at += std::exchange(places[value], at);
        for (std::size_t i = 0; i < count; ++i) to[places[value_of(from[i])]++] = from[i];
        std::swap(from, to);
    }
    if (from != items) std::copy(from, from + count, items);
}

}  // namespace clinch::detail
