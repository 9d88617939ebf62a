#include "src/narrow_phase/chunk_work.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "src/device/stopwatch.hpp"
#include "src/narrow_phase/host_narrow.hpp"
#include "src/narrow_phase/matrix.hpp"

namespace clinch::detail {

void ChunkWork::solve(const NarrowCall& call, std::size_t first, std::size_t count) {
    contacts_.release();
    pairs_ = {call.pairs.data() + first, count};
    group(call);
    find_answers(call, first);
    const Stopwatch watch;
    NarrowTimes& ms = worker_.share().ms;
    const double manifolds_before = ms.manifolds;
    if (worker_.info().unified_memory && (call.only_pairs || !may_have_points()))
        contacts_.take(pairs_, slots_.in_place(call.only_pairs));
    else
        take_gathered(call);
    ms.gather += watch.ms() - (ms.manifolds - manifolds_before);
    worker_.share().pairs += count;
    worker_.share().chunks += 1;
}

void ChunkWork::group(const NarrowCall& call) {
    const Stopwatch watch;
    const bool with_rests = worker_.settings().level != Level::Fast;
    if (worker_.info().unified_memory && pairs_.size() <= worker_.settings().grouped_on_host)
        slots_.group_on_host(pairs_, worker_.scene(), with_rests);
    else
        slots_.group(pairs_, worker_.scene(), static_cast<std::uint32_t>(call.scene.row_count()), with_rests);
    worker_.stage_done();
    worker_.share().ms.buckets += watch.ms();
}

bool ChunkWork::any_starts_warm(const NarrowCall& call) const {
    for (std::size_t k = 0; k < slots_.bucket_count(); ++k)
        if (slots_.bucket(k).count > 0 && worker_.starts_warm(call, k)) return true;
    return false;
}

void ChunkWork::find_answers(const NarrowCall& call, std::size_t first) {
    const Stopwatch watch;
    Device& device = worker_.device();
    const std::size_t corner_bytes = any_starts_warm(call) ? pairs_.size() * sizeof(WarmStart::Impl::Corners) : 0;
    if (corner_bytes > 0) {
        device.reserve(corners_, corner_bytes, "the corners that pairs start from");
        device.write(corners_, call.warm->corners.data() + first, corner_bytes);
    }
    for (std::size_t k = 0; k < slots_.bucket_count(); ++k)
        if (slots_.bucket(k).count > 0) do_bucket(call, k);
    decide(call);
    if (corner_bytes > 0) device.read(corners_, call.warm->corners.data() + first, corner_bytes);
    worker_.stage_done();
    worker_.share().ms.routines += watch.ms();
}

void ChunkWork::do_bucket(const NarrowCall& call, std::size_t k) {
    const BucketSlice bucket = slots_.bucket(k);
    const NarrowSettings& settings = worker_.settings();
    NarrowShare::Bucket& share = worker_.share().buckets[k];
    share.pairs += bucket.count;
    if (!worker_.in_float32(call, k)) {
        share.numbers = "float64";
        if (worker_.info().fp64)
            run_float64(call, k, bucket);
        else
            run_on_host(call, k, bucket);
        return;
    }
    if (settings.options.tolerance) worker_.scene().update(call.scene, settings.shapes, 32);
    run(call, k, bucket, 32);
    share.numbers = settings.level == Level::Fast ? "float32" : "float32, float64";
}

// What float32 has left undecided, in float64.
void ChunkWork::decide(const NarrowCall& call) {
    if (worker_.settings().level == Level::Fast) return;
    const std::array<std::uint32_t, 32> open = slots_.count_undecided();
    for (std::size_t k = 0; k < slots_.bucket_count(); ++k) {
        if (open[k] == 0 || !worker_.in_float32(call, k)) continue;
        const BucketSlice again = slots_.undecided(k, open[k]);
        worker_.share().buckets[k].again += open[k];
        // On a CPU the host is as fast, and builds no kernel for it. Not by their number: chunks may be cut anywhere,
        // and the two differ in last bits.
        if (worker_.info().fp64 && worker_.info().type == DeviceType::Gpu)
            run_float64(call, k, again);
        else
            run_on_host(call, k, again);
    }
}

void ChunkWork::run(const NarrowCall& call, std::size_t k, const BucketSlice& slice, unsigned bits) {
    constexpr std::uint32_t slot_block = Slots::block;
    const DeviceInfo& info = worker_.info();
    const NarrowSettings& settings = worker_.settings();
    const NarrowScene& scene = worker_.scene();
    const std::uint32_t most_items = info.compute_units * (info.lanes > 1 ? 16u : 65536u);
    const std::uint32_t per_item = info.lanes > 1 ? ((slice.count - 1) / most_items / slot_block + 1) * slot_block
                                                  : (slice.count - 1) / most_items + 1;
    const std::uint32_t items = (slice.count - 1) / per_item + 1;
    // What nobody reads may be any buffer.
    const bool with_margins = scene.has_margins();
    const Buffer& margins = with_margins ? scene.margins() : scene.classes();
    const float tolerance = settings.options.tolerance && !call.only_pairs
                                ? static_cast<float>(std::min(*settings.options.tolerance, 3e38))
                                : std::numeric_limits<float>::infinity();
    const Plan& plan = worker_.settings().plans.of(k, call.only_pairs);
    const auto relative = static_cast<float>(bits == 64 ? plan.tolerance64 : plan.tolerance32);
    Kernel& touch = worker_.kernel(call, k, bits);
    touch.args(slots_.pairs(), *slice.numbers, slice.listed ? 1u : 0u, slice.first, slice.count, per_item,
               scene.bodies(bits), scene.shapes(bits), scene.vertices(bits), margins, with_margins ? 1u : 0u,
               slots_.answers(), slots_.stride(), slice.first_slot, tolerance, relative, slots_.hits(),
               slots_.undecided_counts(), static_cast<std::uint32_t>(k));
    if (worker_.starts_warm(call, k)) touch.args_from(19, corners_);
    const std::size_t group = worker_.device().group_size();
    worker_.device().launch(touch, (items + group - 1) / group, group);
}

void ChunkWork::run_float64(const NarrowCall& call, std::size_t k, const BucketSlice& slice) {
    worker_.scene().update(call.scene, worker_.settings().shapes, 64);
    slots_.has_float64();
    run(call, k, slice, 64);
}

void ChunkWork::run_on_host(const NarrowCall& call, std::size_t k, const BucketSlice& slice) {
    std::vector<Pair> again;
    again.reserve(slice.count);
    for (const std::uint32_t number : slots_.numbers(slice)) again.push_back(pairs_[number]);
    RowTolerances tolerances{};
    tolerances[k] = worker_.settings().plans.host_tolerance(k, call.only_pairs);
    slots_.put(slice, touch_on_host(call.scene, worker_.settings().shapes, again, tolerances));
}

// A sphere touches in one point.
bool ChunkWork::may_have_points() const {
    if (worker_.settings().options.contacts_per_pair == 1) return false;
    for (std::size_t k = 0; k < slots_.bucket_count(); ++k)
        if (slots_.bucket(k).count > 0 && matrix()[k].a != sphere_class) return true;
    return false;
}

void ChunkWork::take_gathered(const NarrowCall& call) {
    const std::uint32_t count = slots_.gather(call.only_pairs);
    if (count == 0) return;
    const std::uint64_t stride = slots_.contact_stride();
    Mapping words = worker_.device().map(slots_.contacts(),
                                         slots_.gathered_columns(call.only_pairs) * stride * sizeof(std::uint32_t));
    const GatheredContacts gathered{words.as<std::uint32_t>(), stride, count, slots_.rests()};
    ChunkContacts::Points points;
    if (!call.only_pairs && may_have_points()) points = find_points(call, gathered);
    contacts_.take(std::move(words), gathered, std::move(points));
}

// The manifolds of what slots_.gather() left on the device.
ChunkContacts::Points ChunkWork::find_points(const NarrowCall& call, const GatheredContacts& gathered) {
    const Stopwatch watch;
    const NarrowSettings& settings = worker_.settings();
    const NarrowShapes& shapes = settings.shapes;
    double& ms = worker_.share().ms.manifolds;
    if (!manifolds_) manifolds_ = std::make_unique<Manifolds>(worker_.device());
    const std::uint32_t wanted = settings.options.contacts_per_pair;
    const unsigned bits = settings.level == Level::Exact || settings.options.tolerance ? 64 : 32;
    if (!manifolds_->can(shapes, bits)) {
        std::vector<FewPoints> points = manifolds_on_host(call.scene, shapes, answers_of(gathered), wanted);
        ms += watch.ms();
        return points;
    }
    worker_.scene().update(call.scene, shapes, bits);
    const ContactKinds kinds =
        kinds_of(call.scene, shapes, gathered.words, gathered.words + gathered.stride, gathered.count);
    DevicePoints points;
    manifolds_->find(worker_.scene(), slots_, kinds, gathered.rests, bits, wanted, points);
    ms += watch.ms();
    return points;
}

}  // namespace clinch::detail
