#include "src/narrow_phase/contact_order.hpp"

#include <algorithm>

#include "src/primitives/host_parallel.hpp"
#include "src/primitives/host_radix_sort.hpp"

namespace clinch::detail {
namespace {

constexpr std::size_t least_rows_a_block = 4096, most_blocks = 512;

std::size_t block_size(std::size_t rows) {
    return std::max(least_rows_a_block, rows / most_blocks + 1);
}

std::size_t block_count(std::size_t rows) {
    return (rows + block_size(rows) - 1) / block_size(rows);
}

// Calls what(i) for each row of a block.
template <class What>
void each_of(std::size_t block, std::size_t rows, const What& what) {
    const std::size_t size = block_size(rows);
    for (std::size_t i = block * size, end = std::min(rows, i + size); i < end; ++i) what(i);
}

unsigned bits_of(std::uint64_t value) {
    unsigned bits = 0;
    for (; value != 0; value >>= 1) ++bits;
    return bits;
}

// Asks for a row that is read soon, where there is an instruction for it.
void ask_for(const Contact& row) {
#if defined(__GNUC__)
    const char* const bytes = reinterpret_cast<const char*>(&row);
    __builtin_prefetch(bytes);
    __builtin_prefetch(bytes + sizeof(Contact) - 1);
#else
    (void)row;
#endif
}

}  // namespace

// Rows are cut into blocks, and bodies into as many parts: each block counts and then places its rows by the part of
// their a.
void ContactOrder::deal(View<const std::uint64_t> keys, std::uint32_t bodies) {
    const std::size_t n = keys.size(), count = block_count(n);
    const auto part_of = [&](std::uint64_t key) { return static_cast<std::size_t>((key >> 32) * count / bodies); };
    at_.assign(count * count, 0);
    std::size_t* const at = at_.data();
    parallel_for(count, count > 1,
                 [&](std::size_t k) { each_of(k, n, [&](std::size_t i) { ++at[k * count + part_of(keys[i])]; }); });
    firsts_.clear();
    std::size_t before = 0;
    for (std::size_t p = 0; p < count; ++p) {
        firsts_.push_back(before);
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t there = at[k * count + p];
            at[k * count + p] = before;
            before += there;
        }
    }
    firsts_.push_back(before);
    if (places_.size() < n) {
        places_.resize(n + n / 8);
        spare_.resize(n + n / 8);
    }
    Place* const places = places_.data();
    parallel_for(count, count > 1, [&](std::size_t k) {
        each_of(k, n, [&](std::size_t i) { places[at[k * count + part_of(keys[i])]++] = {keys[i], i}; });
    });
}

// A body that lies against most others, as a floor does, makes a part of most rows: by digits that is no more work a
// row than elsewhere.
void ContactOrder::sort(std::size_t part, std::uint32_t bodies) {
    Place* const first = places_.data() + firsts_[part];
    const std::size_t count = firsts_[part + 1] - firsts_[part];
    if (count < 2) return;
    const unsigned b_bits = bits_of(bodies - 1);
    std::uint64_t least = ~std::uint64_t{0}, most = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint64_t a = first[i].key >> 32;
        least = std::min(least, a);
        most = std::max(most, a);
    }
    host_radix_sort(
        first, spare_.data() + firsts_[part], count, bits_of(most - least) + b_bits,
        [&](const Place& place) { return ((place.key >> 32) - least) << b_bits | (place.key & 0xffffffffu); });
}

void ContactOrder::put(View<const Contact> rows, View<const std::uint64_t> keys, std::uint32_t bodies, Contact* to) {
    const std::size_t n = rows.size(), count = block_count(n);
    deal(keys, bodies);
    parallel_for(count, count > 1, [&](std::size_t part) { sort(part, bodies); });
    constexpr std::size_t ahead = 12;
    parallel_for(count, count > 1, [&](std::size_t k) {
        each_of(k, n, [&](std::size_t i) {
            if (i + ahead < n) ask_for(rows[places_[i + ahead].row]);
            to[i] = rows[places_[i].row];
        });
    });
}

}  // namespace clinch::detail
