// The pairs of one call in buckets on a device, and the slots where their answers lie.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "clinch/aabb.hpp"
#include "clinch/view.hpp"
#include "src/device/device.hpp"
#include "src/narrow_phase/narrow_scene.hpp"
#include "src/primitives/radix_sort.hpp"
#include "src/primitives/scan.hpp"

namespace clinch::detail {

/// Columns of an answer in slots, as COLUMN_... of cl/narrow_phase/driver.clh.
constexpr std::size_t answer_columns = 8;
constexpr std::size_t rest_columns = 7;

/// How long columns of `rows` are made: a multiple of 16, and never of a power of two that would lead a cache to keep
/// what many columns hold of one row in the same few places.
constexpr std::uint64_t column_stride(std::uint64_t rows) {
    return (rows / 1024 + 1) * 1024 + 48;
}

/// HIT and FLOAT64 of cl/narrow_phase/driver.clh.
constexpr std::uint32_t hit_bit = 1, float64_bit = 4;

/// An answer in float64, from the host.
struct HostAnswer {
    std::uint32_t a, b;
    double distance, error;
    double normal[3], point[3];  ///< point of a, from a's position
    bool hit;
};

/// Some pairs of one bucket, on the device: their numbers among the pairs from `first` on (not listed: they are
/// their own), and the slots of their answers.
struct BucketSlice {
    std::uint32_t first = 0, count = 0, first_slot = 0;
    bool listed = false;
    const Buffer* numbers = nullptr;
};

/// The answers of a chunk where they lie, readable on the host while this lives.
struct SlotAnswers {
    Mapping hits, slots, columns;
    bool numbered = false;  ///< else the slot of a pair is its own number
    std::uint64_t stride = 0;
    bool rests = false;  ///< some are float64

    std::size_t slot_of(std::size_t pair) const { return numbered ? slots.as<std::uint32_t>()[pair] : pair; }
    bool is_hit(std::size_t slot) const { return (hits.as<std::uint32_t>()[slot] & hit_bit) != 0; }
    bool is_float64(std::size_t slot) const { return (hits.as<std::uint32_t>()[slot] & float64_bit) != 0; }
};

/// Groups a chunk of pairs by bucket and puts the answers back into their order. Its memory is a few bytes a pair and
/// that of the answers; it is kept from chunk to chunk.
class Slots {
public:
    explicit Slots(Device& device) : device_(device), sort_(device), scan_(device) {}

    /// Most pairs a chunk may have: their answers stay in a core's cache until they are contacts.
    static constexpr std::size_t chunk_pairs = std::size_t{1} << 16;

    /// Slots of a bucket begin at a multiple of this: vectors of answers end in the bucket's own slots.
    static constexpr std::uint32_t block = 16;

    /// Sends the pairs, counts them by bucket, sorts them by it if there are several, and numbers their slots. Waits. A
    /// pair without a bucket is InvalidArgument. `with_rests`: answers may be float64.
    void group(View<const Pair> pairs, const NarrowScene& scene, std::uint32_t bodies, bool with_rests);
    /// The same done by the host, which waits for nothing.
    void group_on_host(View<const Pair> pairs, const NarrowScene& scene, bool with_rests);
    /// The pairs of bucket k; none of them: nothing is to be done.
    const BucketSlice& bucket(std::size_t k) const { return slices_[k]; }
    std::size_t bucket_count() const { return slices_.size(); }

    /// Where a routine adds up how many of the answers of bucket k are undecided, at k.
    const Buffer& undecided_counts() const { return undecided_; }
    /// What was added up so far, of each bucket. Waits.
    std::array<std::uint32_t, 32> count_undecided();
    /// The pairs of bucket k whose answers are undecided, `count` of them, as a slice with slots of its own, which take
    /// the place of the old ones.
    BucketSlice undecided(std::size_t k, std::uint32_t count);
    /// Stores answers of the host in the slots of a slice, one a pair.
    void put(const BucketSlice& slice, const std::vector<HostAnswer>& answers);
    /// Numbers of a slice's pairs, on the host. Waits.
    std::vector<std::uint32_t> numbers(const BucketSlice& slice);

    /// What kernels take.
    const Buffer& pairs() const { return pairs_; }
    const Buffer& answers() const { return answers_; }
    const Buffer& hits() const { return hits_; }
    std::uint64_t stride() const { return stride_; }

    /// Told that answers of this chunk are in float64.
    void has_float64() noexcept { float64_ = true; }
    /// Gathers the contacts into contacts(): a, b, and, unless only pairs are wanted, answer_columns, and, if there are
    /// float64 answers, rest_columns, each contact_stride() long. Returns how many there are. Waits.
    std::uint32_t gather(bool only_pairs);
    std::size_t gathered_columns(bool only_pairs) const {
        return 2 + (only_pairs ? 0 : answer_columns + (float64_ ? rest_columns : 0));
    }
    bool rests() const noexcept { return float64_; }
    /// The answers in place, for a host that shares the device's memory. Waits.
    SlotAnswers in_place(bool only_pairs);
    const Buffer& contacts() const { return contacts_; }
    std::uint64_t contact_stride() const { return contact_stride_; }

private:
    std::uint32_t runs_for(std::uint32_t count) const;
    [[noreturn]] void throw_no_bucket(View<const Pair> pairs);
    void begin(View<const Pair> pairs, bool with_rests);
    bool number_slots(const std::vector<std::uint64_t>& counts);
    void number_pairs(bool listed);

    Device& device_;
    RadixSort sort_;
    Scan scan_;
    Kernel keys_kernel_, slots_kernel_, open_count_, open_fill_, open_slots_, count_kernel_, gather_kernel_;
    Buffer pairs_, table_, keys_, counts_, numbers_, firsts_, first_slots_, slot_of_, hits_, answers_, open_;
    Buffer run_counts_, run_offsets_, undecided_, contacts_;
    std::vector<BucketSlice> slices_;
    std::uint32_t n_ = 0, slots_used_ = 0, buckets_used_ = 0;
    std::uint64_t stride_ = 0, contact_stride_ = 0;
    bool with_rests_ = false, float64_ = false, numbered_ = false;
};

}  // namespace clinch::detail
