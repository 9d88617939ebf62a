// Contacts that were found in any order, put in that of their pairs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "clinch/contact.hpp"
#include "clinch/view.hpp"

namespace clinch::detail {

/// Keeps its memory from call to call.
class ContactOrder {
public:
    /// a, then b.
    static std::uint64_t key(const Contact& c) noexcept { return std::uint64_t{c.a} << 32 | c.b; }

    /// Copies all `rows` to `to`, ascending by their `keys`, whose a and b are below `bodies`; rows of one pair stay in
    /// their order. On the host's threads: two reads of the keys, some of 16 bytes a row in a core's cache, one of the
    /// rows, at random places, and one write.
    void put(View<const Contact> rows, View<const std::uint64_t> keys, std::uint32_t bodies, Contact* to);

private:
    struct Place {
        std::uint64_t key;
        std::size_t row;
    };
    void deal(View<const std::uint64_t> keys, std::uint32_t bodies);
    void sort(std::size_t part, std::uint32_t bodies);

    std::vector<Place> places_, spare_;  // of all rows, part by part
    std::vector<std::size_t> at_;        // of each part in each block
    std::vector<std::size_t> firsts_;    // of each part in places_; the end
};

}  // namespace clinch::detail
