#include "src/narrow_phase/contact_order.hpp"

#include <algorithm>
#include <tuple>

#include "src/primitives/host_parallel.hpp"

namespace clinch::detail {
namespace {

constexpr std::size_t least_rows_a_part = 4096, most_parts = 512;

}  // namespace

// Rows are cut into blocks, and bodies into as many parts. Each block counts and then places its rows by parts; each
// part is put in order.
void ContactOrder::put(View<const Contact> rows, View<const std::uint64_t> keys, std::uint32_t bodies, Contact* to) {
    const std::size_t n = rows.size(), size = std::max(least_rows_a_part, n / most_parts + 1),
                      count = (n + size - 1) / size;
    const auto part_of = [&](std::uint64_t key) { return static_cast<std::size_t>((key >> 32) * count / bodies); };
    const auto each = [&](std::size_t block, const auto& what) {
        for (std::size_t i = block * size, end = std::min(n, i + size); i < end; ++i) what(i);
    };
    at_.assign(count * count, 0);  // rows of each part in each block, then their places
    std::size_t* const at = at_.data();
    parallel_for(count, count > 1,
                 [&](std::size_t k) { each(k, [&](std::size_t i) { ++at[k * count + part_of(keys[i])]; }); });
    std::vector<std::size_t> firsts;
    std::size_t before = 0;
    for (std::size_t p = 0; p < count; ++p) {
        firsts.push_back(before);
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t there = at[k * count + p];
            at[k * count + p] = before;
            before += there;
        }
    }
    firsts.push_back(before);
    if (places_.size() < n) places_.resize(n + n / 8);
    Place* const places = places_.data();
    parallel_for(count, count > 1, [&](std::size_t k) {
        each(k, [&](std::size_t i) { places[at[k * count + part_of(keys[i])]++] = {keys[i], i}; });
    });
    parallel_for(count, count > 1, [&](std::size_t p) {
        Place* const first = places + firsts[p];
        Place* const end = places + firsts[p + 1];
        std::sort(first, end,
                  [](const Place& x, const Place& y) { return std::tie(x.key, x.row) < std::tie(y.key, y.row); });
        std::transform(first, end, to + firsts[p], [&](const Place& place) { return rows[place.row]; });
    });
}

}  // namespace clinch::detail
