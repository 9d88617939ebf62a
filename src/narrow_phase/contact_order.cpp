#include "src/narrow_phase/contact_order.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>

#include "src/primitives/host_parallel.hpp"

namespace clinch::detail {
namespace {

constexpr std::size_t least_rows_a_part = 4096, most_parts = 512;

// A stretch of a list.
using Block = View<const Contact>;

std::vector<Block> blocks_of(const std::vector<View<const Contact>>& lists) {
    std::size_t rows = 0;
    for (const View<const Contact>& list : lists) rows += list.size();
    const std::size_t size = std::max(least_rows_a_part, rows / most_parts + 1);
    std::vector<Block> blocks;
    for (const View<const Contact>& list : lists)
        for (std::size_t first = 0; first < list.size(); first += size)
            blocks.emplace_back(list.data() + first, std::min(size, list.size() - first));
    return blocks;
}

// Parts are ranges of a, as many as there are blocks.
class Parts {
public:
    Parts(std::uint32_t bodies, std::size_t count) : bodies_(bodies), count_(count) {}
    std::size_t of(const Contact& c) const { return static_cast<std::size_t>(std::uint64_t{c.a} * count_ / bodies_); }

private:
    std::uint64_t bodies_, count_;
};

}  // namespace

void ContactOrder::put(const std::vector<View<const Contact>>& lists, std::uint32_t bodies, Contact* to) {
    const std::vector<Block> blocks = blocks_of(lists);
    const std::size_t count = blocks.size();
    const Parts part(bodies, count);
    at_.assign(count * count, 0);  // rows of each part in each block, then their places
    std::size_t* const at = at_.data();
    parallel_for(count, count > 1, [&](std::size_t k) {
        for (const Contact& c : blocks[k]) ++at[k * count + part.of(c)];
    });
    std::vector<std::size_t> firsts;
    std::size_t rows = 0;
    for (std::size_t p = 0; p < count; ++p) {
        firsts.push_back(rows);
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t there = at[k * count + p];
            at[k * count + p] = rows;
            rows += there;
        }
    }
    firsts.push_back(rows);
    if (places_.size() < rows) places_.resize(rows + rows / 8);
    Place* const places = places_.data();
    parallel_for(count, count > 1, [&](std::size_t k) {
        for (const Contact& c : blocks[k]) places[at[k * count + part.of(c)]++] = {std::uint64_t{c.a} << 32 | c.b, &c};
    });
    parallel_for(count, count > 1, [&](std::size_t p) {
        Place* const first = places + firsts[p];
        Place* const end = places + firsts[p + 1];
        // Rows of one pair stand in one list, one behind the other.
        std::sort(first, end, [](const Place& x, const Place& y) {
            return x.key != y.key ? x.key < y.key : std::less<const Contact*>()(x.row, y.row);
        });
        std::transform(first, end, to + firsts[p], [](const Place& place) { return *place.row; });
    });
}

}  // namespace clinch::detail
