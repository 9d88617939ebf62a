// host-sweep: sweep and prune on the host, the thesis' sequential reference [1.3.1.4; Baraff 1992]. Boxes stay sorted
// by their min on one axis from call to call; an insertion sort repairs the order, so that a still or nearly still
// scene costs hardly more than the tests. What is kept decides time alone, never which pairs there are.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "src/broad_phase/algorithm.hpp"
#include "src/primitives/host_parallel.hpp"
#include "src/primitives/host_radix_sort.hpp"

// Compiled for several processors; the program's start chooses. Not beneath a sanitizer, which is not up by then.
#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define CLINCH_FOR_EACH_PROCESSOR __attribute__((target_clones("arch=skylake-avx512", "avx2", "default")))
#else
#define CLINCH_FOR_EACH_PROCESSOR
#endif

namespace clinch::detail {
namespace {

constexpr std::size_t block = 16;               // boxes tested at once, in plain loops that compilers vectorise
constexpr std::size_t rows_at_once = 256;       // boxes whose pairs make one list
constexpr std::size_t lists_at_once = 256;      // between two calls of progress
constexpr std::size_t shifts_a_box = 16;        // an insertion sort of more is slower than sorting anew
constexpr std::size_t boxes_a_descent = 4;      // fewer for each descent: the order is lost
constexpr std::size_t few_boxes = 128;          // sorted by comparing; more by the digits of their keys
constexpr std::uint64_t pairs_kept = 1u << 20;  // memory for more is given back before the result takes its own
// Up to so many tests, or pairs to sort, one thread is done before others have surely begun.
constexpr std::uint64_t serial_tests = std::uint64_t{1} << 23, serial_pairs = std::uint64_t{1} << 20;
// So many tests a box, and twice those at first, are borne before a better axis is looked for.
constexpr std::size_t tests_borne = 64;

bool valid(const Aabb& box) {
    constexpr float most = std::numeric_limits<float>::max();
    bool ok = true;
    for (int d = 0; d < 3; ++d) ok &= (box.min[d] <= box.max[d]) & (box.min[d] >= -most) & (box.max[d] <= most);
    return ok;
}

// Grows with x, which is no NaN.
std::uint32_t ordered(float x) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &x, sizeof bits);
    return bits ^ ((bits >> 31) != 0 ? 0xffffffffu : 0x80000000u);
}

// Of what is no box: behind all boxes.
constexpr std::uint32_t last_key = 0xffffffffu;

// A box on the sorted axis.
struct Entry {
    std::uint32_t key;  // of the min, or last_key
    std::uint32_t id;
};

// Stable. Uses `spare`.
void sort_entries(std::vector<Entry>& entries, std::vector<Entry>& spare) {
    if (entries.size() <= few_boxes) {
        std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.key < b.key; });
        return;
    }
    spare.resize(entries.size());
    host_radix_sort(entries.data(), spare.data(), entries.size(), 32, [](const Entry& entry) { return entry.key; });
}

// The axis on which the centres vary most; of two alike the first.
std::size_t axis_of_variance(View<const Aabb> boxes) {
    std::array<double, 3> mean{}, squares{};
    double count = 0.0;
    for (const Aabb& box : boxes) {
        if (!valid(box)) continue;
        count += 1.0;
        for (std::size_t d = 0; d < 3; ++d) {  // [Welford 1962]
            const double centre = 0.5 * static_cast<double>(box.min[d]) + 0.5 * static_cast<double>(box.max[d]);
            const double from = centre - mean[d];
            mean[d] += from / count;
            squares[d] += from * (centre - mean[d]);
        }
    }
    return static_cast<std::size_t>(std::max_element(squares.begin(), squares.end()) - squares.begin());
}

// What one run of rows found.
struct Found {
    std::vector<Pair> pairs;   // none of them where only their count is asked for
    std::uint64_t passed = 0;  // pairs
    std::uint64_t filtered = 0, unmoving = 0, tests = 0;
    bool keeps = true;
};

// Place of the lowest bit that is set, of which there is one.
inline std::uint32_t lowest_bit(std::uint32_t bits) {
#if defined(__GNUC__)
    return static_cast<std::uint32_t>(__builtin_ctz(bits));
#else
    std::uint32_t place = 0;
    for (; (bits & 1u) == 0; bits >>= 1) ++place;
    return place;
#endif
}

// Pairs on their way to a list.
class PairBuffer {
public:
    explicit PairBuffer(Found& found) : found_(found) {}

    // The pairs of `a` with those of block ids whose bit is set.
    void add(std::uint32_t a, const std::uint32_t* ids, std::uint32_t bits) {
        if (count_ > most - block) flush();
        for (; bits != 0; bits &= bits - 1) {
            const std::uint32_t b = ids[lowest_bit(bits)];
            pairs_[count_++] = {std::min(a, b), std::max(a, b)};
        }
    }
    void flush() {
        found_.passed += count_;
        if (found_.keeps) found_.pairs.insert(found_.pairs.end(), pairs_, pairs_ + count_);
        count_ = 0;
    }

private:
    static constexpr std::size_t most = 512;
    Found& found_;
    std::size_t count_ = 0;
    Pair pairs_[most];
};

// In the order of the axis: min and max on it, on the next one, and on the one after that.
using Columns = std::array<std::vector<float>, 6>;

// A box on the two axes that are not sorted.
struct SideBounds {
    float min_u, max_u, min_v, max_v;
};

// Which of the boxes from `j` on begin before `end_s` and overlap `box` on the other axes, as bits. A plain loop
// without branches, which compilers turn into vector code.
std::uint32_t test_block(const Columns& columns, std::size_t j, float end_s, const SideBounds& box) {
    static constexpr std::uint32_t lane_bit[block]{1u << 0,  1u << 1,  1u << 2,  1u << 3, 1u << 4,  1u << 5,
                                                   1u << 6,  1u << 7,  1u << 8,  1u << 9, 1u << 10, 1u << 11,
                                                   1u << 12, 1u << 13, 1u << 14, 1u << 15};
    const float *const min_s = columns[0].data() + j, *const min_u = columns[2].data() + j,
                       *const max_u = columns[3].data() + j, *const min_v = columns[4].data() + j,
                       *const max_v = columns[5].data() + j;
    const SideBounds b = box;
    std::uint32_t hits = 0;
    for (std::size_t l = 0; l < block; ++l) {
        const std::uint32_t hit =
            static_cast<std::uint32_t>(min_s[l] <= end_s) & static_cast<std::uint32_t>(min_u[l] <= b.max_u) &
            static_cast<std::uint32_t>(max_u[l] >= b.min_u) & static_cast<std::uint32_t>(min_v[l] <= b.max_v) &
            static_cast<std::uint32_t>(max_v[l] >= b.min_v);
        hits |= lane_bit[l] & (0u - hit);
    }
    return hits;
}

class HostSweep : public BroadPhaseAlgorithm {
public:
    explicit HostSweep(const BroadPhaseOptions& options) : options_(options) {}

    void find(BoxInput& input, const FilterInput& filters, PairList& pairs, FindCounts& counts) override;

private:
    void number(View<const Aabb> boxes);
    std::size_t look_up_keys(View<const Aabb> boxes);
    bool repair();
    void line_up(View<const Aabb> boxes);
    void fill_columns(View<const Aabb> boxes);
    void test_rows(std::size_t first, std::size_t end, const FilterInput& filters, Found& found) const;
    void put(std::uint32_t a, std::uint32_t b, const FilterInput& filters, Found& found) const;
    void deliver(PairList& pairs, FindCounts& counts);
    std::vector<Pair> joined_by_rows(std::uint64_t total) const;

    const BroadPhaseOptions& options_;
    std::vector<Entry> order_, spare_;
    std::size_t axis_ = 0;
    std::size_t boxes_ = 0;  // entries that are boxes: the first ones
    Columns columns_;
    std::vector<std::uint32_t> ids_;    // of the columns
    std::uint64_t tests_at_first_ = 0;  // of the call that chose the axis
    std::uint64_t tests_ = 0;           // of the last call
    bool choose_axis_ = true;
    std::vector<Found> found_;
};

// Forgets the order there was.
void HostSweep::number(View<const Aabb> boxes) {
    axis_ = axis_of_variance(boxes);
    order_.resize(boxes.size());
    for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = {0, static_cast<std::uint32_t>(i)};
}

// Returns how many entries stand behind one with a larger key.
std::size_t HostSweep::look_up_keys(View<const Aabb> boxes) {
    std::uint32_t last = 0;
    std::size_t descents = 0;
    for (Entry& entry : order_) {
        const Aabb& box = boxes[entry.id];
        entry.key = valid(box) ? ordered(box.min[axis_]) : last_key;
        descents += entry.key < last ? 1u : 0u;
        last = entry.key;
    }
    return descents;
}

// Insertion sort; gives up, with the entries all there in some order, when it takes too long.
bool HostSweep::repair() {
    std::size_t left = shifts_a_box * order_.size();
    for (std::size_t i = 1; i < order_.size(); ++i) {
        const Entry entry = order_[i];
        std::size_t k = i;
        for (; k > 0 && entry.key < order_[k - 1].key; --k) order_[k] = order_[k - 1];
        order_[k] = entry;
        if (i - k > left) return false;
        left -= i - k;
    }
    return true;
}

// Brings the boxes in order.
void HostSweep::line_up(View<const Aabb> boxes) {
    if (order_.size() != boxes.size()) choose_axis_ = true;
    if (choose_axis_) number(boxes);
    const std::size_t descents = look_up_keys(boxes);
    if (descents > order_.size() / boxes_a_descent || !repair()) sort_entries(order_, spare_);
    const auto first_none =
        std::partition_point(order_.begin(), order_.end(), [](const Entry& entry) { return entry.key != last_key; });
    boxes_ = static_cast<std::size_t>(first_none - order_.begin());
}

void HostSweep::fill_columns(View<const Aabb> boxes) {
    const std::size_t u = (axis_ + 1) % 3, v = (axis_ + 2) % 3;
    for (auto& column : columns_) column.resize(boxes_ + block);
    ids_.resize(boxes_ + block);
    for (std::size_t i = 0; i < boxes_; ++i) {
        const Aabb& box = boxes[order_[i].id];
        ids_[i] = order_[i].id;
        columns_[0][i] = box.min[axis_];
        columns_[1][i] = box.max[axis_];
        columns_[2][i] = box.min[u];
        columns_[3][i] = box.max[u];
        columns_[4][i] = box.min[v];
        columns_[5][i] = box.max[v];
    }
    for (auto& column : columns_)  // ends every range
        std::fill(column.begin() + static_cast<std::ptrdiff_t>(boxes_), column.end(),
                  std::numeric_limits<float>::infinity());
}

void HostSweep::put(std::uint32_t a, std::uint32_t b, const FilterInput& filters, Found& found) const {
    if (!filters.allows(a, b)) {
        ++found.filtered;
    } else if (!filters.can_move(a) && !filters.can_move(b)) {
        ++found.unmoving;
    } else {
        ++found.passed;
        if (found.keeps) found.pairs.push_back({std::min(a, b), std::max(a, b)});
    }
}

// Rows [first, end) of the order against those behind them that begin before they end.
CLINCH_FOR_EACH_PROCESSOR
void HostSweep::test_rows(std::size_t first, std::size_t end, const FilterInput& filters, Found& found) const {
    const bool filtered = filters.any();
    PairBuffer buffer(found);
    for (std::size_t i = first; i < end; ++i) {
        const float end_s = columns_[1][i];
        const SideBounds box{columns_[2][i], columns_[3][i], columns_[4][i], columns_[5][i]};
        std::size_t j = i + 1;
        for (; columns_[0][j] <= end_s; j += block) {
            std::uint32_t hits = test_block(columns_, j, end_s, box);
            if (!filtered) {
                buffer.add(ids_[i], ids_.data() + j, hits);
                continue;
            }
            for (; hits != 0; hits &= hits - 1) put(ids_[i], ids_[j + lowest_bit(hits)], filters, found);
        }
        found.tests += std::min(j, boxes_) - (i + 1);
    }
    buffer.flush();
}

// All pairs in order: counted, scanned and filled by their first body, each such row sorted by itself.
std::vector<Pair> HostSweep::joined_by_rows(std::uint64_t total) const {
    std::vector<std::uint64_t> ends(order_.size() + 1, 0);
    for (const Found& part : found_)
        for (const Pair& pair : part.pairs) ++ends[std::size_t{pair.a} + 1];
    std::partial_sum(ends.begin(), ends.end(), ends.begin());
    std::vector<Pair> all(total);
    for (const Found& part : found_)  // a row's entry moves from its first to its end
        for (const Pair& pair : part.pairs) all[ends[pair.a]++] = pair;
    const auto at = [&](std::uint64_t i) { return all.begin() + static_cast<std::ptrdiff_t>(i); };
    const std::size_t runs = (order_.size() + rows_at_once - 1) / rows_at_once;
    parallel_for(runs, total > serial_pairs, [&](std::size_t run) {
        const std::size_t end = std::min(order_.size(), (run + 1) * rows_at_once);
        for (std::size_t a = run * rows_at_once; a < end; ++a) std::sort(at(a == 0 ? 0 : ends[a - 1]), at(ends[a]));
    });
    return all;
}

void HostSweep::deliver(PairList& pairs, FindCounts& counts) {
    std::uint64_t total = 0, tests = 0;
    for (const Found& part : found_) {
        total += part.passed;
        tests += part.tests;
        counts.pairs_filtered += part.filtered;
        counts.static_pairs += part.unmoving;
    }
    counts.box_tests += tests;
    tests_ = tests;
    if (choose_axis_) tests_at_first_ = tests;
    choose_axis_ = tests / 2 > tests_at_first_ + tests_borne * boxes_;
    check_limit(total, options_);
    if (pairs.counts_only()) {
        pairs.add_count(total);
        return;
    }
    if (options_.order == Order::Sorted && total > order_.size() / 16) {
        const std::vector<Pair> all = joined_by_rows(total);
        if (total > pairs_kept) found_.clear();
        pairs.append(all);
        return;
    }
    std::vector<Pair> few;  // sorting them takes less than a look at every row
    const bool sorted = options_.order == Order::Sorted;
    for (const Found& part : found_) {
        if (sorted)
            few.insert(few.end(), part.pairs.begin(), part.pairs.end());
        else
            pairs.append(part.pairs);
    }
    std::sort(few.begin(), few.end());
    if (sorted) pairs.append(few);
}

void HostSweep::find(BoxInput& input, const FilterInput& filters, PairList& pairs, FindCounts& counts) {
    const View<const Aabb> boxes = input.on_host();
    // Another number of boxes: a guess. It decides on threads, nothing else.
    const std::uint64_t n = boxes.size(), expected_tests = n == order_.size() ? tests_ : n * n / 64;
    line_up(boxes);
    fill_columns(boxes);
    counts.invalid_boxes = boxes_ < boxes.size();

    const std::size_t lists = (boxes_ + rows_at_once - 1) / rows_at_once;
    found_.resize(lists);
    for (Found& part : found_) {  // keeps the memory
        part.pairs.clear();
        part.passed = part.filtered = part.unmoving = part.tests = 0;
        part.keeps = !pairs.counts_only();
    }
    for (std::size_t list = 0; list < lists; list += lists_at_once) {
        if (options_.progress) options_.progress(static_cast<double>(list) / static_cast<double>(lists));
        parallel_for(std::min(lists_at_once, lists - list), expected_tests > serial_tests, [&](std::size_t k) {
            const std::size_t first = (list + k) * rows_at_once;
            test_rows(first, std::min(boxes_, first + rows_at_once), filters, found_[list + k]);
        });
    }
    deliver(pairs, counts);
}

}  // namespace

std::unique_ptr<BroadPhaseAlgorithm> make_host_sweep(Device*, const BroadPhaseOptions& options) {
    return std::make_unique<HostSweep>(options);
}

}  // namespace clinch::detail
