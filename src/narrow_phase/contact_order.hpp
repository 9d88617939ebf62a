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
    /// their order. On the host's threads: two reads of the keys, some of 8 or 16 bytes a row in a core's cache, one of
    /// the rows, at random places, and one write.
    void put(View<const Contact> rows, View<const std::uint64_t> keys, std::uint32_t bodies, Contact* to);

private:
    // A row and its key: of which bodies its part has, and b.
    template <class Word>
    struct Place {
        Word key, row;
    };
    template <class Word>
    struct Places {
        std::vector<Place<Word>> all, spare;  // part by part
    };
    template <class Word>
    void put_by(Places<Word>& places, View<const Contact> rows, View<const std::uint64_t> keys, Contact* to);
    template <class Word>
    void deal(Places<Word>& places, View<const std::uint64_t> keys);

    std::uint64_t scale_ = 1;              // a body's a times this, over 2^32, is its part
    unsigned b_bits_ = 0, part_bits_ = 0;  // of a key
    Places<std::uint32_t> narrow_;         // where keys are that short
    Places<std::uint64_t> wide_;
    std::vector<std::size_t> at_;      // of each part in each block
    std::vector<std::size_t> firsts_;  // places of each part; the end
};

}  // namespace clinch::detail
