#include "src/broad_phase/incremental.hpp"

#include <algorithm>
#include <utility>

#include "src/device/stopwatch.hpp"

namespace clinch::detail {
namespace {

constexpr char module[] = "broad_phase/incremental";
constexpr std::uint32_t none = 0xffffffffu;
constexpr std::uint32_t block = 1024, slice = 1024;  // BLOCK and SLICE of the kernels
// A fattened box is larger by this share of its longest side, on every side of it. Larger: bodies leave it less
// often; smaller: fewer pairs to keep. A body that has left once moves, and will again.
constexpr float fat_share = 1.0f / 64, mover_share = 1.0f / 8;
// Spare entries for bodies that have left, and how many may leave in one step: beyond, all is built anew.
constexpr std::uint32_t bodies_a_spare = 32, bodies_a_leaver = 64;
constexpr std::size_t least_extras = 1024;  // room for extra pairs from the start

unsigned bits_of(std::uint32_t value) {
    unsigned bits = 0;
    for (; value != 0; value >>= 1) ++bits;
    return std::max(bits, 1u);
}

// Columns of bodies that have left: whole vectors, whatever the lanes.
std::uint32_t padded(std::uint32_t count) {
    return (count + 15) / 16 * 16;
}

BroadPhaseOptions inner_options(const BroadPhaseOptions& options, Order order) {
    BroadPhaseOptions inner;
    inner.order = order;
    inner.scratch_bytes = options.scratch_bytes;
    return inner;
}

}  // namespace

Incremental::Incremental(Device& device, const BroadPhaseOptions& options)
    : device_(device),
      options_(options),
      fat_options_(inner_options(options, Order::Sorted)),
      query_options_(inner_options(options, Order::Any)),
      grid_(device, fat_options_),
      sink_(device, query_options_),
      sort_(device),
      scan_(device) {}

void Incremental::make_kernels() {
    if (fill_) return;
    fatten_ = device_.kernel(module, "inc_fatten");
    places_ = device_.kernel(module, "inc_places");
    split_ = device_.kernel(module, "inc_split");
    first_rows_ = device_.kernel(module, "inc_first_rows");
    states_kernel_ = device_.kernel(module, "inc_states");
    apply_ = device_.kernel(module, "inc_apply");
    move_ = device_.kernel(module, "inc_move");
    retest_ = device_.kernel(module, "inc_retest");
    extra_kernel_ = device_.kernel(module, "inc_extra");
    count_ = device_.kernel(module, "inc_count");
    fill_ = device_.kernel(module, "inc_fill");
}

Incremental::FilterRow Incremental::filter_row(const FilterInput& filters, std::uint32_t body) const {
    return {filters.group(body), filters.mask(body), filters.can_move(body)};
}

bool Incremental::build(BoxInput& boxes, const FilterInput& filters, PairList& pairs, FindCounts& counts) {
    forget();
    make_kernels();
    const std::uint32_t n = boxes.count();
    const cl_mem rows = boxes.on(device_);
    spare_room_ = n / bodies_a_spare;
    grid_.set_spare(spare_room_);
    filter_rows_.clear();
    if (filters.any()) {
        filter_rows_.reserve(n);
        for (std::uint32_t i = 0; i < n; ++i) filter_rows_.push_back(filter_row(filters, i));
    }
    ++filter_version_;
    {
        Buffer fat = device_.allocate(std::size_t{n} * sizeof(Aabb), "fattened boxes");
        device_.launch_items(fatten_.args(rows, boxes.first(), n, fat_share, fat), n);
        BoxInput fat_boxes(device_, fat.handle(), 0, n);
        PairList fat_pairs;
        FindCounts of_search;
        grid_.find(fat_boxes, {filters.columns, filter_version_}, fat_pairs, of_search);
        if (!grid_.binned() || fat_pairs.size() > most_pairs_a_body * n || fat_pairs.size() > most_pairs())
            return false;
        keep_pairs(fat_pairs.view(), n);
        counts.box_tests += of_search.box_tests;
        counts.pairs_filtered += of_search.pairs_filtered;
        counts.static_pairs += of_search.static_pairs;
        any_invalid_ = of_search.invalid_boxes;
    }
    device_.reserve(place_, std::size_t{n} * sizeof(std::uint32_t), "the places of bodies");
    device_.reserve(left_, std::size_t{n} * sizeof(std::uint32_t), "bodies that have left");
    device_.reserve(first_of_a_, (std::size_t{n} + 1) * sizeof(std::uint32_t), "the pairs of bodies");
    device_.reserve(first_of_b_, (std::size_t{n} + 1) * sizeof(std::uint32_t), "the pairs of bodies");
    device_.clear(left_, std::size_t{n} * sizeof(std::uint32_t));
    device_.launch_items(places_.args(grid_.bins().order, n, place_), n);
    const std::size_t runs = std::size_t{n} / 256 + 1;
    device_.launch_items(first_rows_.args(a_, kept_, n, first_of_a_), runs);
    // offsets_ holds the numbers of b in order here.
    device_.launch_items(first_rows_.args(offsets_, kept_, n, first_of_b_), runs);
    spare_entry_.assign(n, none);
    left_now_.assign(n / 64 + 1, 0);
    extra_.clear();
    spare_used_ = 0;
    frame_ = 0;
    compute_states(boxes);
    counts.invalid_boxes = any_invalid_;
    put_out(pairs, counts);
    bodies_ = n;
    return true;
}

// Pairs that one buffer holds; they are numbered in 32 bits.
std::uint64_t Incremental::most_pairs() const {
    return std::min<std::uint64_t>(device_.info().max_allocation / sizeof(Pair), none);
}

// Pairs as two columns, and their numbers in the order of b.
void Incremental::keep_pairs(View<const Pair> fat_pairs, std::uint32_t bodies) {
    kept_ = static_cast<std::uint32_t>(fat_pairs.size());
    const std::size_t column = (std::size_t{kept_} + Grid::padding) * sizeof(std::uint32_t);
    device_.reserve(out_, fat_pairs.size() * sizeof(Pair), "pairs");
    device_.write(out_, fat_pairs.data(), fat_pairs.size() * sizeof(Pair));
    device_.reserve(a_, column, "kept pairs");
    device_.reserve(b_, column, "kept pairs");
    device_.reserve(by_b_, column, "kept pairs");
    device_.reserve(offsets_, column, "kept pairs");
    if (kept_ == 0) return;
    device_.launch_items(split_.args(out_, kept_, a_, b_, offsets_), kept_);
    sort_.sort(offsets_, by_b_, kept_, bits_of(bodies - 1), true);
}

void Incremental::compute_states(BoxInput& boxes) {
    const std::size_t bytes = (std::size_t{kept_} / block + 2) * block;
    device_.reserve(states_, bytes, "the states of pairs");
    device_.clear(states_, bytes);
    if (kept_ > 0)
        device_.launch_items(states_kernel_.args(boxes.on(device_), boxes.first(), a_, b_, kept_, states_), kept_);
}

bool Incremental::update(BoxInput& boxes, const Changes& changes, const FilterInput& filters, PairList& pairs,
                         FindCounts& counts) {
    try {
        // Filters that come or go concern all.
        if (filters.any() != filter_rows_.empty() && step(boxes, changes, filters, pairs, counts)) return true;
    } catch (...) {
        forget();
        throw;
    }
    forget();
    return false;
}

bool Incremental::step(BoxInput& boxes, const Changes& changes, const FilterInput& filters, PairList& pairs,
                       FindCounts& counts) {
    ++frame_;
    const std::vector<Leaver> leavers = find_leavers(boxes, changes, filters);
    if (spare_used_ > spare_room_ || leavers.size() > bodies_ / bodies_a_leaver) return false;
    if (!leavers.empty()) {
        move(boxes, leavers);
        query(leavers, filters, counts);
        if (kept_ + extra_.size() > most_pairs()) return false;
        for (const Leaver& leaver : leavers) left_now_[leaver.body / 64] = 0;
    }
    retest(boxes, changes);
    counts.invalid_boxes = any_invalid_;
    counts.boxes_inside += changes.bodies.size() - std::min(changes.bodies.size(), leavers.size());
    put_out(pairs, counts);
    return true;
}

// Bodies whose filters are others than in the last step.
std::vector<std::uint32_t> Incremental::filter_changes(const Changes& changes, const FilterInput& filters) {
    std::vector<std::uint32_t> found;
    if (filter_rows_.empty()) return found;
    const auto look_at = [&](std::uint32_t body) {
        const FilterRow row = filter_row(filters, body);
        if (!(filter_rows_[body] != row)) return;
        filter_rows_[body] = row;
        found.push_back(body);
    };
    if (changes.any_filter)
        for (std::uint32_t i = 0; i < bodies_; ++i) look_at(i);
    else
        for (const std::uint32_t i : changes.bodies) look_at(i);
    if (!found.empty()) ++filter_version_;
    return found;
}

void Incremental::leave(std::uint32_t body, std::vector<Leaver>& leavers) {
    if (has_left(body)) return;
    left_now_[body / 64] |= std::uint64_t{1} << body % 64;
    if (spare_entry_[body] == none) spare_entry_[body] = bodies_ + spare_used_++;
    leavers.push_back({body, spare_entry_[body]});
}

// Brings the boxes up to date; gives the bodies that have left their fattened box, or must be looked for afresh.
std::vector<Incremental::Leaver> Incremental::find_leavers(BoxInput& boxes, const Changes& changes,
                                                           const FilterInput& filters) {
    std::vector<Leaver> leavers;
    const auto count = static_cast<std::uint32_t>(changes.bodies.size());
    if (count > 0) {
        const GridBins bins = grid_.bins();
        device_.reserve(changed_, count * sizeof(std::uint32_t), "changed bodies");
        device_.reserve(marks_, count * sizeof(std::uint32_t), "changed bodies");
        device_.reserve(rows_, count * sizeof(Aabb), "changed boxes");
        device_.write(changed_, changes.bodies.data(), count * sizeof(std::uint32_t));
        if (changes.boxes != nullptr) device_.write(rows_, changes.boxes, count * sizeof(Aabb));
        apply_.args(changed_, count, rows_, changes.boxes == nullptr ? 1u : 0u, boxes.on(device_), boxes.first(),
                    bins.columns, bins.stride, place_, marks_);
        device_.launch_items(apply_, count);
        std::vector<std::uint32_t> marks(count);
        device_.read(marks_, marks.data(), count * sizeof(std::uint32_t));
        for (std::uint32_t i = 0; i < count; ++i) {
            if (marks[i] != 0) leave(changes.bodies[i], leavers);
            any_invalid_ = any_invalid_ || marks[i] > 1;
        }
    }
    for (const std::uint32_t body : filter_changes(changes, filters)) leave(body, leavers);
    return leavers;
}

void Incremental::move(BoxInput& boxes, const std::vector<Leaver>& leavers) {
    const GridBins bins = grid_.bins();
    const auto count = static_cast<std::uint32_t>(leavers.size());
    const std::uint32_t stride = padded(count);
    device_.reserve(leavers_, count * sizeof(Leaver), "bodies that have left");
    device_.reserve(leaver_columns_, std::size_t{stride} * 6 * sizeof(float), "bodies that have left");
    device_.reserve(leaver_ids_, stride * sizeof(std::uint32_t), "bodies that have left");
    device_.write(leavers_, leavers.data(), count * sizeof(Leaver));
    move_.args(leavers_, count, stride, leaver_columns_, leaver_ids_, boxes.on(device_), boxes.first(), mover_share,
               bodies_, frame_, bins.columns, bins.stride, bins.order, place_, left_, first_of_a_, first_of_b_, by_b_,
               states_);
    device_.launch_items(move_, stride);
}

// The pairs of bodies that have left take the place of those they had among the extra pairs.
void Incremental::query(const std::vector<Leaver>& leavers, const FilterInput& filters, FindCounts& counts) {
    QueryKernels& kernels = query_kernels_[filters.any() ? 1 : 0];
    if (!kernels.spare) {
        kernels.grid = device_.kernel(module, "inc_query", PairSink::defines(filters));
        kernels.spare = device_.kernel(module, "inc_query_spare", PairSink::defines(filters));
    }
    const GridBins bins = grid_.bins();
    const auto count = static_cast<std::uint32_t>(leavers.size());
    const std::uint32_t slices = (spare_used_ + slice - 1) / slice, lanes = device_.info().lanes;
    kernels.grid.args(leavers_, bins.columns, bins.stride, bins.order, bins.start, bins.frame);
    kernels.spare.args(leaver_columns_, padded(count), leaver_ids_, bins.columns, bins.stride, bins.order, left_,
                       frame_, bodies_, bodies_ + spare_used_, slices);
    PairList found;
    sink_.collect({{&kernels.grid, 6, count}, {&kernels.spare, 11, (count + lanes - 1) / lanes * slices}},
                  {filters.columns, filter_version_}, bodies_, found, counts);
    extra_.erase(
        std::remove_if(extra_.begin(), extra_.end(), [&](const Pair& p) { return has_left(p.a) || has_left(p.b); }),
        extra_.end());
    const auto middle = static_cast<std::ptrdiff_t>(extra_.size());
    extra_.insert(extra_.end(), found.view().begin(), found.view().end());
    std::sort(extra_.begin() + middle, extra_.end());
    std::inplace_merge(extra_.begin(), extra_.begin() + middle, extra_.end());
    device_.reserve(extra_buffer_, extra_.size() * sizeof(Pair), "extra pairs");
    device_.write(extra_buffer_, extra_.data(), extra_.size() * sizeof(Pair));
}

void Incremental::retest(BoxInput& boxes, const Changes& changes) {
    const auto count = static_cast<std::uint32_t>(changes.bodies.size());
    if (count > 0 && kept_ > 0) {
        retest_.args(changed_, count, boxes.on(device_), boxes.first(), bodies_, place_, a_, b_, first_of_a_,
                     first_of_b_, by_b_, states_);
        device_.launch_items(retest_, count);
    }
    if (extra_.empty()) return;
    const auto extras = static_cast<std::uint32_t>(extra_.size());
    device_.reserve(extra_states_, extras * sizeof(std::uint32_t), "the states of extra pairs");
    device_.launch_items(extra_kernel_.args(extra_buffer_, extras, boxes.on(device_), boxes.first(), extra_states_),
                         extras);
}

// The kept and extra pairs whose boxes overlap, merged.
void Incremental::put_out(PairList& pairs, FindCounts& counts) {
    const auto extras = static_cast<std::uint32_t>(extra_.size());
    const std::uint32_t blocks = std::max(1u, (kept_ + block - 1) / block);
    device_.reserve(extra_buffer_, least_extras * sizeof(Pair), "extra pairs");
    device_.reserve(extra_states_, least_extras * sizeof(std::uint32_t), "the states of extra pairs");
    device_.reserve(counts_, blocks * sizeof(std::uint32_t), "the counts of pairs");
    device_.reserve(offsets_, blocks * sizeof(std::uint32_t), "the offsets of pairs");
    count_.args(a_, b_, states_, kept_, extra_buffer_, extra_states_, extras, blocks, counts_);
    device_.launch_items(count_, blocks);
    scan_.exclusive(counts_, blocks, offsets_);
    const std::uint32_t total = scan_.total();
    check_limit(total, options_);
    if (total == 0) return;
    device_.reserve(out_, std::size_t{total} * sizeof(Pair), "pairs");
    fill_.args(a_, b_, states_, kept_, extra_buffer_, extra_states_, extras, blocks, offsets_, counts_, out_);
    device_.launch_items(fill_, blocks);
    const Stopwatch watch;
    pairs.adopt(device_.map(out_, std::size_t{total} * sizeof(Pair)), total);
    counts.download_ms += watch.ms();
}

}  // namespace clinch::detail
