#include "src/narrow_phase/slots.hpp"

#include <algorithm>
#include <cmath>

#include "clinch/error.hpp"
#include "src/device/quirks.hpp"
#include "src/narrow_phase/matrix.hpp"

namespace clinch::detail {
namespace {

constexpr const char* module = "narrow_phase/buckets";
constexpr std::uint32_t most_buckets = 32;
constexpr unsigned key_bits = 5;

std::uint32_t in_blocks(std::uint32_t count) {
    return (count + Slots::block - 1) / Slots::block * Slots::block;
}

}  // namespace

// Work-items that share `count` pairs: enough to keep all cores busy, and no loop too long.
std::uint32_t Slots::runs_for(std::uint32_t count) const {
    const DeviceInfo& info = device_.info();
    const std::uint32_t least = count / (most_loop_iterations(info) / 40) + 1;
    return std::max(least, std::clamp(count / 1024, 1u, info.compute_units * (info.lanes > 1 ? 8u : 64u)));
}

void Slots::begin(View<const Pair> pairs, bool with_rests) {
    n_ = static_cast<std::uint32_t>(pairs.size());
    with_rests_ = with_rests;
    float64_ = false;
    if (!keys_kernel_) {  // made last
        slots_kernel_ = device_.kernel(module, "bucket_slots");
        table_ = device_.allocate(bucket_table().size(), "the table of buckets");
        device_.write(table_, bucket_table().data(), bucket_table().size());
        undecided_ = device_.allocate(most_buckets * sizeof(std::uint32_t), "the counts of undecided pairs");
        keys_kernel_ = device_.kernel(module, "bucket_keys");
    }
    device_.clear(undecided_, most_buckets * sizeof(std::uint32_t));
    device_.reserve(pairs_, n_ * sizeof(Pair), "the pairs of a chunk");
    device_.write(pairs_, pairs.data(), n_ * sizeof(Pair));
}

void Slots::group(View<const Pair> pairs, const NarrowScene& scene, std::uint32_t bodies, bool with_rests) {
    begin(pairs, with_rests);
    const std::uint32_t items = runs_for(n_), per_item = (n_ - 1) / items + 1;
    device_.reserve(keys_, n_ * sizeof(std::uint32_t), "the buckets of pairs");
    device_.reserve(counts_, std::size_t{items} * most_buckets * sizeof(std::uint32_t), "the counts of buckets");
    const std::size_t group = device_.group_size();
    device_.launch(keys_kernel_.args(pairs_, n_, scene.classes(), bodies, table_, per_item, items, keys_, counts_),
                   (items + group - 1) / group, group);
    std::vector<std::uint32_t> by_item(std::size_t{items} * most_buckets);
    device_.read(counts_, by_item.data(), by_item.size() * sizeof by_item[0]);
    std::vector<std::uint64_t> counts(most_buckets, 0);
    for (std::size_t i = 0; i < by_item.size(); ++i) counts[i % most_buckets] += by_item[i];
    if (counts[no_bucket] > 0) throw_no_bucket(pairs);
    if (!number_slots(counts)) return;
    sort_.sort(keys_, numbers_, n_, key_bits, true);
    number_pairs(true);
}

void Slots::group_on_host(View<const Pair> pairs, const NarrowScene& scene, bool with_rests) {
    const View<const std::uint8_t> classes = scene.classes_on_host();
    std::vector<std::uint8_t> buckets(pairs.size());
    std::vector<std::uint64_t> counts(most_buckets, 0);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const Pair& pair = pairs[i];
        const std::uint8_t a = pair.a < classes.size() ? classes[pair.a] : no_class,
                           b = pair.b < classes.size() ? classes[pair.b] : no_class;
        buckets[i] = a < 8 && b < 8 && pair.a < pair.b ? bucket_table()[8 * std::size_t{a} + b] : no_bucket;
        if (buckets[i] == no_bucket) throw_no_routine(pair);
        ++counts[buckets[i]];
    }
    begin(pairs, with_rests);
    if (!number_slots(counts)) return;
    std::vector<std::uint32_t> numbers(pairs.size()), slots(pairs.size());
    std::array<std::uint32_t, most_buckets> done{};
    for (std::uint32_t i = 0; i < n_; ++i) {
        const BucketSlice& slice = slices_[buckets[i]];
        const std::uint32_t place = done[buckets[i]]++;
        numbers[slice.first + place] = i;
        slots[i] = slice.first_slot + place;
    }
    device_.write(numbers_, numbers.data(), n_ * sizeof(std::uint32_t));
    device_.write(slot_of_, slots.data(), n_ * sizeof(std::uint32_t));
    numbered_ = true;
}

// Says which pair it is that no bucket takes.
void Slots::throw_no_bucket(View<const Pair> pairs) {
    std::vector<std::uint32_t> keys(n_);
    device_.read(keys_, keys.data(), keys.size() * sizeof keys[0]);
    const auto i = static_cast<std::size_t>(std::find(keys.begin(), keys.end(), no_bucket) - keys.begin());
    throw_no_routine(pairs[i]);
}

// Returns whether there are several buckets.
bool Slots::number_slots(const std::vector<std::uint64_t>& counts) {
    std::vector<std::uint32_t> first_pair, first_slot;
    slices_.assign(matrix().size(), {});
    const bool listed = std::count_if(counts.begin(), counts.end(), [](std::uint64_t c) { return c > 0; }) > 1;
    std::uint32_t pairs_before = 0;
    slots_used_ = 0;
    for (std::size_t k = 0; k < slices_.size(); ++k) {
        const auto count = static_cast<std::uint32_t>(counts[k]);
        if (count == 0) continue;
        slices_[k] = {pairs_before, count, slots_used_, listed, &numbers_};
        first_pair.push_back(pairs_before);
        first_slot.push_back(slots_used_);
        pairs_before += count;
        slots_used_ += in_blocks(count);
    }
    // Room for every pair a second time: it may be undecided.
    const std::size_t slots = with_rests_ ? std::size_t{2} * slots_used_ + matrix().size() * block : slots_used_;
    const std::uint64_t stride = std::max(stride_, column_stride(slots));
    device_.reserve(answers_, stride * (answer_columns + (with_rests_ ? rest_columns : 0)) * sizeof(float), "answers");
    device_.reserve(hits_, stride * sizeof(std::uint32_t), "the hits among pairs");
    stride_ = stride;  // not sooner: a call that found no room is not to make the next ask for it
    device_.reserve(slot_of_, n_ * sizeof(std::uint32_t), "the slots of pairs");
    device_.reserve(numbers_, n_ * sizeof(std::uint32_t), "the numbers of pairs");
    device_.reserve(firsts_, most_buckets * sizeof(std::uint32_t), "the places of buckets");
    device_.reserve(first_slots_, most_buckets * sizeof(std::uint32_t), "the slots of buckets");
    device_.write(firsts_, first_pair.data(), first_pair.size() * sizeof(std::uint32_t));
    device_.write(first_slots_, first_slot.data(), first_slot.size() * sizeof(std::uint32_t));
    buckets_used_ = static_cast<std::uint32_t>(first_pair.size());
    numbered_ = false;
    return listed;
}

// Writes down the slot of each pair.
void Slots::number_pairs(bool listed) {
    if (numbered_) return;
    device_.launch_items(
        slots_kernel_.args(numbers_, listed ? 1u : 0u, n_, firsts_, first_slots_, buckets_used_, slot_of_), n_);
    numbered_ = true;
}

std::array<std::uint32_t, 32> Slots::count_undecided() {
    std::array<std::uint32_t, most_buckets> counts{};
    device_.read(undecided_, counts.data(), sizeof counts);
    return counts;
}

BucketSlice Slots::undecided(std::size_t k, std::uint32_t count) {
    const BucketSlice& bucket = slices_[k];
    number_pairs(bucket.listed);
    if (!open_count_) {  // made last
        open_fill_ = device_.kernel(module, "open_fill");
        open_slots_ = device_.kernel(module, "open_slots");
        open_count_ = device_.kernel(module, "open_count");
    }
    const std::uint32_t runs = runs_for(bucket.count), per_run = (bucket.count - 1) / runs + 1;
    device_.reserve(run_counts_, runs * sizeof(std::uint32_t), "the counts of runs");
    device_.reserve(run_offsets_, runs * sizeof(std::uint32_t), "the offsets of runs");
    const std::size_t group = device_.group_size(), groups = (runs + group - 1) / group;
    device_.launch(open_count_.args(hits_, bucket.first_slot, bucket.count, per_run, runs, run_counts_), groups, group);
    scan_.exclusive(run_counts_, runs, run_offsets_);
    // The queue is in order: the next bucket's list is written when this one's has been worked through.
    device_.reserve(open_, n_ * sizeof(std::uint32_t), "the undecided pairs");
    device_.launch(open_fill_.args(hits_, bucket.first_slot, bucket.count, per_run, runs, run_offsets_, numbers_,
                                   bucket.listed ? 1u : 0u, bucket.first, open_),
                   groups, group);
    device_.launch_items(open_slots_.args(open_, count, slots_used_, slot_of_), count);
    const BucketSlice slice{0, count, slots_used_, true, &open_};
    slots_used_ += in_blocks(count);
    return slice;
}

void Slots::put(const BucketSlice& slice, const std::vector<HostAnswer>& answers) {
    std::vector<std::uint32_t> hits(slice.count);
    for (std::size_t i = 0; i < hits.size(); ++i)
        hits[i] = (answers[i].hit ? hit_bit : 0) | (with_rests_ ? float64_bit : 0);
    device_.write(hits_, hits.data(), hits.size() * sizeof hits[0], slice.first_slot * sizeof hits[0]);
    float64_ = float64_ || with_rests_;
    std::vector<float> column(slice.count), rest(slice.count);
    const auto put = [&](std::size_t c, std::size_t r, auto value) {
        for (std::size_t i = 0; i < column.size(); ++i) {
            const double x = value(answers[i]);
            column[i] = static_cast<float>(x);
            rest[i] = static_cast<float>(x - static_cast<double>(column[i]));
        }
        const std::size_t bytes = column.size() * sizeof(float);
        device_.write(answers_, column.data(), bytes, (c * stride_ + slice.first_slot) * sizeof(float));
        if (r > 0 && with_rests_)
            device_.write(answers_, rest.data(), bytes, (r * stride_ + slice.first_slot) * sizeof(float));
    };
    put(0, 8, [](const HostAnswer& a) { return a.distance; });
    const double rounding = with_rests_ ? 0x1p-46 : 0x1p-23;
    put(1, 0, [rounding](const HostAnswer& a) {  // widened as the driver does
        return (a.error + rounding * std::fabs(a.distance)) * 1.0000002 + 1e-37;
    });
    for (std::size_t d = 0; d < 3; ++d) {
        put(2 + d, 9 + d, [d](const HostAnswer& a) { return a.normal[d]; });
        put(5 + d, 12 + d, [d](const HostAnswer& a) { return a.point[d]; });
    }
}

std::vector<std::uint32_t> Slots::numbers(const BucketSlice& slice) {
    std::vector<std::uint32_t> out(slice.count);
    if (slice.listed)
        device_.read(*slice.numbers, out.data(), out.size() * sizeof out[0], slice.first * sizeof out[0]);
    else
        for (std::uint32_t i = 0; i < slice.count; ++i) out[i] = slice.first + i;
    return out;
}

std::uint32_t Slots::gather(bool only_pairs) {
    if (!count_kernel_) {  // made last
        gather_kernel_ = device_.kernel(module, "contact_gather");
        count_kernel_ = device_.kernel(module, "contact_count");
    }
    number_pairs(false);
    const std::uint32_t runs = runs_for(n_), per_run = (n_ - 1) / runs + 1;
    device_.reserve(run_counts_, runs * sizeof(std::uint32_t), "the counts of runs");
    device_.reserve(run_offsets_, runs * sizeof(std::uint32_t), "the offsets of runs");
    const std::size_t group = device_.group_size(), groups = (runs + group - 1) / group;
    device_.launch(count_kernel_.args(hits_, slot_of_, n_, per_run, runs, run_counts_), groups, group);
    scan_.exclusive(run_counts_, runs, run_offsets_);
    const std::uint32_t count = scan_.total();
    if (count == 0) return 0;
    const std::uint64_t stride = std::max(contact_stride_, column_stride(count));
    device_.reserve(contacts_, stride * gathered_columns(only_pairs) * sizeof(std::uint32_t), "contacts");
    contact_stride_ = stride;
    device_.launch(gather_kernel_.args(pairs_, hits_, slot_of_, n_, per_run, runs, run_offsets_, answers_, stride_,
                                       only_pairs ? 0u : 1u, float64_ ? 1u : 0u, contacts_, contact_stride_),
                   groups, group);
    return count;
}

SlotAnswers Slots::in_place(bool only_pairs) {
    SlotAnswers out;
    out.numbered = numbered_;
    out.stride = stride_;
    out.rests = float64_;
    // The last one waits for all.
    if (numbered_) out.slots = device_.map_later(slot_of_, n_ * sizeof(std::uint32_t));
    if (!only_pairs)
        out.columns =
            device_.map_later(answers_, stride_ * (answer_columns + (float64_ ? rest_columns : 0)) * sizeof(float));
    out.hits = device_.map(hits_, std::size_t{slots_used_} * sizeof(std::uint32_t));
    return out;
}

}  // namespace clinch::detail
