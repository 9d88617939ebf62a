#include "src/narrow_phase/contact_order.hpp"

#include <algorithm>

#include "src/primitives/bits.hpp"
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
template <class Word>
void ContactOrder::deal(Places<Word>& places, View<const std::uint64_t> keys) {
    const std::size_t n = keys.size(), count = block_count(n);
    const std::uint64_t scale = scale_;
    const auto part_of = [scale](std::uint64_t key) { return static_cast<std::size_t>((key >> 32) * scale >> 32); };
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
    if (places.all.size() < n) {
        places.all.resize(n + n / 8);
        places.spare.resize(n + n / 8);
    }
    Place<Word>* const all = places.all.data();
    std::vector<std::uint64_t> bodies(count);  // that each part begins with
    for (std::size_t p = 0; p < count; ++p) bodies[p] = ((std::uint64_t{p} << 32) + scale - 1) / scale;
    parallel_for(count, count > 1, [&](std::size_t k) {
        each_of(k, n, [&, b_bits = b_bits_](std::size_t i) {
            const std::size_t part = part_of(keys[i]);
            const std::uint64_t key = ((keys[i] >> 32) - bodies[part]) << b_bits | (keys[i] & 0xffffffffu);
            all[at[k * count + part]++] = {static_cast<Word>(key), static_cast<Word>(i)};
        });
    });
}

// A body that lies against most others, as a floor does, makes a part of most rows: by digits that is no more work a
// row than elsewhere.
template <class Word>
void ContactOrder::put_by(Places<Word>& places, View<const Contact> rows, View<const std::uint64_t> keys, Contact* to) {
    const std::size_t n = rows.size(), count = block_count(n);
    deal(places, keys);
    Place<Word>* const all = places.all.data();
    parallel_for(count, count > 1, [&](std::size_t part) {
        host_radix_sort(all + firsts_[part], places.spare.data() + firsts_[part], firsts_[part + 1] - firsts_[part],
                        std::min(64u, part_bits_ + b_bits_), [](const Place<Word>& place) { return place.key; });
    });
    constexpr std::size_t ahead = 12;
    parallel_for(count, count > 1, [&](std::size_t k) {
        each_of(k, n, [&](std::size_t i) {
            if (i + ahead < n) ask_for(rows[all[i + ahead].row]);
            to[i] = rows[all[i].row];
        });
    });
}

void ContactOrder::put(View<const Contact> rows, View<const std::uint64_t> keys, std::uint32_t bodies, Contact* to) {
    const std::size_t n = rows.size();
    if (n == 0) return;
    scale_ = (std::uint64_t{block_count(n)} << 32) / bodies;
    b_bits_ = bits_of(std::uint64_t{bodies} - 1);
    part_bits_ = bits_of((std::uint64_t{1} << 32) / scale_ + 1);
    if (b_bits_ + part_bits_ <= 32 && n <= 0xffffffffu)
        put_by(narrow_, rows, keys, to);
    else
        put_by(wide_, rows, keys, to);
}

}  // namespace clinch::detail
