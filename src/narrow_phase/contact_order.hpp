// Contacts that were found in any order, put in that of their pairs.
#pragma once

#include <cstdint>
#include <vector>

#include "clinch/contact.hpp"
#include "clinch/view.hpp"

namespace clinch::detail {

/// Keeps its memory from call to call.
class ContactOrder {
public:
    /// Copies all rows of `lists` to `to`, ascending by a, then b, numbers below `bodies`. The rows of a pair must
    /// stand together in one list, and stay in their order. On the host's threads: three reads of the lists, of which
    /// the last is at random places, and one write.
    void put(const std::vector<View<const Contact>>& lists, std::uint32_t bodies, Contact* to);

private:
    struct Place {
        std::uint64_t key;  // a, then b
        const Contact* row;
    };
    std::vector<Place> places_;
    std::vector<std::size_t> at_;
};

}  // namespace clinch::detail
