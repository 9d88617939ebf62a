// brute: every box against every other on a device [thesis 3.1.2, 4.2]. See cl/broad_phase/brute.cl.
#include <algorithm>
#include <limits>
#include <vector>

#include "src/broad_phase/algorithm.hpp"
#include "src/broad_phase/columns.hpp"
#include "src/device/stopwatch.hpp"
#include "src/primitives/scan.hpp"

namespace clinch::detail {
namespace {

constexpr std::uint32_t block = 512;                                         // BLOCK of the kernel
constexpr std::uint32_t fill_entries_an_item = 16;                           // FILL_ENTRIES of the kernel
constexpr std::size_t bits_bytes = block / 8;                                // of one entry: a row against a block
constexpr std::size_t entry_bytes = bits_bytes + 2 * sizeof(std::uint32_t);  // bits, count, offset

// Rows [first, end) that are worked on at once, and the tiles they touch.
struct Batch {
    std::uint32_t first, end;
    std::uint32_t blocks;  // of all columns

    std::uint32_t width() const { return blocks - first / block; }
    std::uint32_t entries() const { return (end - first) * width(); }
    // Tiles of the rows of blocks before `row_block`: blocks + (blocks - 1) + ...
    std::uint64_t tiles_before(std::uint64_t row_block) const {
        return row_block * blocks - row_block * (row_block - 1) / 2;
    }
    std::uint64_t first_tile() const { return tiles_before(first / block); }
    std::uint64_t tiles() const { return tiles_before((end - 1) / block + 1) - first_tile(); }
};

class Brute : public BroadPhaseAlgorithm {
public:
    Brute(Device& device, const BroadPhaseOptions& options)
        : device_(device), options_(options), columns_(device), scan_(device), filters_(device) {}

    void find(BoxInput& boxes, const FilterInput& filters, PairList& pairs, FindCounts& counts) override;

private:
    Batch next_batch(std::uint32_t first, std::uint32_t n) const;
    void test(const Batch& batch, const FilterInput& filters, std::uint32_t n);
    void fill(const Batch& batch, std::uint32_t found, bool only_one, PairList& pairs, FindCounts& counts);
    void fill_entries(const Batch& batch, std::uint32_t first, std::uint32_t end, std::uint32_t count);
    void read_dropped(FindCounts& counts);

    Device& device_;
    const BroadPhaseOptions& options_;
    BoxColumns columns_;
    Scan scan_;
    FilterMirror filters_;
    Kernel tiles_kernel_, filtered_tiles_kernel_, fill_kernel_;
    Buffer bits_, counts_, offsets_, pairs_, dropped_;
};

Batch Brute::next_batch(std::uint32_t first, std::uint32_t n) const {
    Batch batch{first, n, columns_.stride() / block};
    // Offsets are 32-bit: a batch has fewer than 2^32 bits.
    const std::size_t most_entries =
        std::min({options_.scratch_bytes / entry_bytes, device_.info().max_allocation / bits_bytes,
                  std::size_t{std::numeric_limits<std::uint32_t>::max()} / block});
    std::uint64_t rows = std::max<std::uint64_t>(1, most_entries / batch.width());
    if (rows >= block) rows = rows / block * block;
    batch.end = static_cast<std::uint32_t>(std::min<std::uint64_t>(n, first + rows));
    return batch;
}

void Brute::test(const Batch& batch, const FilterInput& filters, std::uint32_t n) {
    device_.reserve(bits_, std::size_t{batch.entries()} * bits_bytes, "the bits of brute");
    device_.reserve(counts_, std::size_t{batch.entries()} * sizeof(std::uint32_t), "the counts of brute");
    device_.reserve(offsets_, std::size_t{batch.entries()} * sizeof(std::uint32_t), "the offsets of brute");

    // Enough work-groups to keep every unit busy to the end (PoCL hands out several at a time), with rows for every
    // item of a group.
    const std::size_t group = device_.group_size();
    std::uint32_t slices = 1;
    while (slices < block / 8 && block / slices > group &&
           batch.tiles() * slices < 256 * std::uint64_t{device_.info().compute_units})
        slices *= 2;

    Kernel& kernel = filters.any() ? filtered_tiles_kernel_ : tiles_kernel_;
    if (!kernel) kernel = device_.kernel("broad_phase/brute", "brute_tiles", filters.any() ? "-DFILTERS=1" : "");
    const std::uint64_t first_tile = batch.first_tile();
    if (filters.any()) {
        device_.reserve(dropped_, 2 * sizeof(std::uint32_t), "the counts of dropped pairs");
        device_.clear(dropped_, 2 * sizeof(std::uint32_t));
        kernel.args(columns_.buffer(), columns_.stride(), batch.blocks, first_tile, slices, batch.first, batch.end,
                    bits_, counts_, filters_.on_device(filters, n), dropped_, LocalMemory{2 * sizeof(std::uint32_t)});
    } else {
        kernel.args(columns_.buffer(), columns_.stride(), batch.blocks, first_tile, slices, batch.first, batch.end,
                    bits_, counts_);
    }
    device_.launch(kernel, batch.tiles() * slices, group);
    scan_.exclusive(counts_, batch.entries(), offsets_);
}

void Brute::fill_entries(const Batch& batch, std::uint32_t first, std::uint32_t end, std::uint32_t count) {
    if (!fill_kernel_) fill_kernel_ = device_.kernel("broad_phase/brute", "brute_fill");
    device_.reserve(pairs_, std::size_t{count} * sizeof(Pair), "pairs");
    fill_kernel_.args(bits_, counts_, offsets_, first, end, batch.first, batch.blocks, pairs_);
    device_.launch_items(fill_kernel_, (end - first + fill_entries_an_item - 1) / fill_entries_an_item);
}

void Brute::fill(const Batch& batch, std::uint32_t found, bool only_one, PairList& pairs, FindCounts& counts) {
    if (pairs.counts_only()) pairs.add_count(found);
    if (found == 0 || pairs.counts_only()) return;
    // Pairs of one launch: at least a whole entry.
    const std::uint64_t wanted = std::max<std::uint64_t>(
        std::min<std::uint64_t>(4 * options_.scratch_bytes / sizeof(Pair), pairs.piece()), block);
    const auto most = static_cast<std::uint32_t>(std::min({wanted, device_.info().max_allocation / sizeof(Pair),
                                                           std::uint64_t{std::numeric_limits<std::uint32_t>::max()}}));
    if (found <= most) {
        fill_entries(batch, 0, batch.entries(), found);
        const Stopwatch watch;
        Mapping mapping = device_.map(pairs_, std::size_t{found} * sizeof(Pair));
        if (only_one)
            pairs.adopt(std::move(mapping), found);
        else
            pairs.append(mapping.as<Pair>(), found);
        counts.download_ms += watch.ms();
        return;
    }
    // More than one buffer should hold: as many whole entries at a time as fit.
    std::vector<std::uint32_t> offsets(batch.entries());
    device_.read(offsets_, offsets.data(), offsets.size() * sizeof(std::uint32_t));
    for (std::uint32_t first = 0; first < batch.entries();) {
        const auto past =
            std::upper_bound(offsets.begin() + first, offsets.end(), std::uint64_t{offsets[first]} + most);
        const auto end = past == offsets.end() && found - offsets[first] <= most
                             ? batch.entries()
                             : static_cast<std::uint32_t>(past - offsets.begin()) - 1;
        const std::uint32_t count = (end == batch.entries() ? found : offsets[end]) - offsets[first];
        fill_entries(batch, first, end, count);
        const Mapping mapping = device_.map(pairs_, std::size_t{count} * sizeof(Pair));
        pairs.append(mapping.as<Pair>(), count);
        first = end;
    }
}

void Brute::read_dropped(FindCounts& counts) {
    std::uint32_t dropped[2] = {0, 0};
    device_.read(dropped_, dropped, sizeof dropped);
    counts.pairs_filtered += dropped[0];
    counts.static_pairs += dropped[1];
}

void Brute::find(BoxInput& boxes, const FilterInput& filters, PairList& pairs, FindCounts& counts) {
    const std::uint32_t n = boxes.count();
    if (n < 2) {
        counts.invalid_boxes = n == 1;  // one box is looked at on the host
        return;
    }
    columns_.make(boxes, block);
    std::uint64_t total = 0;
    for (std::uint32_t first = 0; first < n;) {
        const Batch batch = next_batch(first, n);
        test(batch, filters, n);
        const std::uint32_t found = scan_.total();
        if (filters.any()) read_dropped(counts);
        total += found;
        // Past the limit the rest is only counted, so that the error can name the true count.
        if (total <= options_.max_pairs) fill(batch, found, first == 0 && batch.end == n, pairs, counts);
        if (options_.progress) options_.progress(1.0 - static_cast<double>(n - batch.end) / n * (n - batch.end) / n);
        first = batch.end;
    }
    check_limit(total, options_);
    counts.invalid_boxes = columns_.any_invalid();
    counts.box_tests += std::uint64_t{n} * (n - 1) / 2;
}

}  // namespace

std::unique_ptr<BroadPhaseAlgorithm> make_brute(Device* device, const BroadPhaseOptions& options) {
    return std::make_unique<Brute>(*device, options);
}

}  // namespace clinch::detail
