#include "clinch/narrow_phase.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "clinch/error.hpp"
#include "src/device/context_impl.hpp"
#include "src/device/quirks.hpp"
#include "src/device/stopwatch.hpp"
#include "src/narrow_phase/contact_list.hpp"
#include "src/narrow_phase/cursor.hpp"
#include "src/narrow_phase/host_narrow.hpp"
#include "src/narrow_phase/manifolds.hpp"
#include "src/narrow_phase/matrix.hpp"
#include "src/narrow_phase/narrow_scene.hpp"
#include "src/narrow_phase/slots.hpp"
#include "src/narrow_phase/warm_start_impl.hpp"

namespace clinch {
namespace {

using namespace detail;

// What float32 answers are good for: see NarrowPhaseOptions::precision.
enum class Level { Fast, Certain, Exact };

Level level_of(const NarrowPhaseOptions& options) {
    if (options.tolerance) return Level::Certain;
    return options.precision < 0.25 ? Level::Fast : options.precision < 0.75 ? Level::Certain : Level::Exact;
}

void check_options(const NarrowPhaseOptions& options) {
    if (!(options.precision >= 0.0 && options.precision <= 1.0))
        throw Error(ErrorCode::InvalidArgument,
                    "precision is " + std::to_string(options.precision) + " and must be from 0 to 1");
    if (options.contacts_per_pair < 1 || options.contacts_per_pair > most_points)
        throw Error(ErrorCode::InvalidArgument, "contacts_per_pair is " + std::to_string(options.contacts_per_pair) +
                                                    " and must be from 1 to " + std::to_string(most_points));
    if (options.tolerance && !(*options.tolerance > 0.0 && std::isfinite(*options.tolerance)))
        throw Error(ErrorCode::InvalidArgument,
                    "tolerance is " + std::to_string(*options.tolerance) + " and must be a positive length");
}

}  // namespace

struct NarrowPhase::Impl {
    Impl(Context& c, const NarrowPhaseOptions& o)
        : context(c.impl()), options(o), level(level_of(o)), shapes(o.contacts_per_pair > 1) {
        check_options(o);
    }

    Context::Impl& context;
    NarrowPhaseOptions options;
    Level level;
    NarrowShapes shapes;
    std::unique_ptr<NarrowScene> on_device;
    std::unique_ptr<Slots> slots;
    std::unique_ptr<Manifolds> manifolds;
    // Of a bucket, in 32 and 64 bits: for contacts, and for only which pairs touch; from nothing, and warm.
    std::array<std::array<std::array<std::array<Kernel, 2>, 2>, 2>, 32> kernels;
    std::array<std::array<std::optional<Plan>, 2>, 32> plans;  // of a bucket, as kernels; until shapes change
    bool only_pairs = false;                                   // what the call that is under way asks for
    WarmStart::Impl* warm = nullptr;                           // its own, if it may use one
    Buffer corners;                                            // of the pairs of a chunk
    ContactList contacts;
    std::vector<Pair> touching;
    NarrowReport report;

    void find(const Scene& scene, View<const Pair> pairs, bool touching_only, WarmStart* from);
    bool worth_a_device(std::size_t pairs) const;
    void find_on_host(const Scene& scene, View<const Pair> pairs);
    void find_on_device(const Scene& scene, View<const Pair> pairs);
    void do_chunk(const Scene& scene, View<const Pair> pairs, std::size_t first);
    bool starts_warm(std::size_t k);
    bool any_starts_warm();
    void do_bucket(const Scene& scene, View<const Pair> pairs, std::size_t k);
    void decide(const Scene& scene, View<const Pair> pairs);
    void run(std::size_t k, const BucketSlice& slice, unsigned bits);
    void run_float64(const Scene& scene, std::size_t k, const BucketSlice& slice) {
        on_device->update(scene, shapes, 64);
        slots->has_float64();
        run(k, slice, 64);
    }
    void run_on_host(const Scene& scene, View<const Pair> pairs, const BucketSlice& slice);
    void gather(const Scene& scene, View<const Pair> pairs);
    void take_in_place(const Scene& scene, View<const Pair> pairs);
    void take_gathered(const Scene& scene);
    bool may_have_points() const;
    void append_points(const Scene& scene, const GatheredContacts& gathered);
    Kernel& kernel(std::size_t k, unsigned bits);
    const Plan& plan(std::size_t k);
    RowTolerances host_tolerances();
    bool in_float32(std::size_t k);
    Device& device() const { return context.open(context.primary()); }
    void stage_done() const {
        if (options.measure_stages) device().finish();
    }
};

// Few pairs are done on the host before a device has been told of them.
bool NarrowPhase::Impl::worth_a_device(std::size_t pairs) const {
    constexpr std::size_t few_pairs = 128;
    if (context.infos.empty() || pairs < few_pairs) return false;
    return context.infos[context.primary()].fp64 || level != Level::Exact;
}

void NarrowPhase::Impl::find(const Scene& scene, View<const Pair> pairs, bool touching_only, WarmStart* from) {
    const Stopwatch total;
    only_pairs = touching_only;
    warm = from != nullptr && worth_a_device(pairs.size()) ? &from->impl() : nullptr;
    contacts.clear();
    touching.clear();
    report = NarrowReport{};
    report.pairs = pairs.size();
    for (const MatrixRow& row : matrix()) report.buckets.push_back({classes_text(row), row.module, {}, 0, 0});
    const Stopwatch upload;
    const bool shapes_changed = shapes.update(scene);
    if (shapes_changed) {
        plans = {};
        if (on_device) on_device->shapes_changed();  // also where this call has no need of the device
    }
    report.ms.upload = upload.ms();
    try {
        if (worth_a_device(pairs.size()))
            find_on_device(scene, pairs);
        else
            find_on_host(scene, pairs);
    } catch (...) {
        contacts.clear();
        touching.clear();
        if (from != nullptr) from->clear();
        if (on_device) on_device->forget();
        throw;
    }
    const Stopwatch finish;
    if (on_device && on_device->has_margins()) contacts.drop_beyond_margins(scene);
    report.ms.gather += finish.ms();
    report.contacts = only_pairs ? touching.size() : contacts.size();
    if (options.tolerance) report.tolerance_missed = contacts.count_above(*options.tolerance);
    report.cells_skipped = static_cast<std::uint64_t>(std::count_if(
        report.buckets.begin(), report.buckets.end(), [](const BucketReport& bucket) { return bucket.pairs == 0; }));
    report.buckets.erase(std::remove_if(report.buckets.begin(), report.buckets.end(),
                                        [](const BucketReport& bucket) { return bucket.pairs == 0; }),
                         report.buckets.end());
    for (const auto& opened : context.devices)
        if (opened != nullptr) report.peak_device_bytes += opened->report().peak_bytes;
    report.ms.total = total.ms();
}

void NarrowPhase::Impl::find_on_host(const Scene& scene, View<const Pair> pairs) {
    const Stopwatch watch;
    for (const Pair& pair : pairs) {
        const MatrixRow* const row = row_of(scene, shapes, pair);
        if (row == nullptr) throw_no_routine(pair);
        BucketReport& bucket = report.buckets[static_cast<std::size_t>(row - matrix().data())];
        ++bucket.pairs;
        bucket.numbers = "float64";
    }
    for (std::size_t first = 0; first < pairs.size(); first += Slots::chunk_pairs) {
        const std::vector<HostAnswer> answers =
            touch_on_host(scene, shapes, {pairs.data() + first, std::min(Slots::chunk_pairs, pairs.size() - first)},
                          host_tolerances());
        if (only_pairs) {
            for (const HostAnswer& answer : answers)
                if (answer.hit) touching.push_back({answer.a, answer.b});
            continue;
        }
        std::vector<FewPoints> points;
        if (options.contacts_per_pair > 1)
            points = manifolds_on_host(scene, shapes, answers, options.contacts_per_pair);
        contacts.append(scene, answers, points);
    }
    report.ms.routines = watch.ms();
}

void NarrowPhase::Impl::find_on_device(const Scene& scene, View<const Pair> pairs) {
    if (!on_device) {
        on_device = std::make_unique<NarrowScene>(device());
        slots = std::make_unique<Slots>(device());
    }
    const Stopwatch upload;
    on_device->update_classes(scene, shapes);
    if (!options.tolerance) on_device->update(scene, shapes, level == Level::Exact ? 64 : 32);
    if (warm != nullptr) report.warm = warm->take(pairs);
    stage_done();
    report.ms.upload += upload.ms();
    for (std::size_t first = 0; first < pairs.size(); first += Slots::chunk_pairs)
        do_chunk(scene, {pairs.data() + first, std::min(Slots::chunk_pairs, pairs.size() - first)}, first);
}

// Whether the cell has iterations, and a device does them.
bool NarrowPhase::Impl::starts_warm(std::size_t k) {
    const MatrixRow& row = matrix()[k];
    return warm != nullptr && !row.lanes && row.a != plane_class &&
           (in_float32(k) || context.infos[context.primary()].fp64);
}

bool NarrowPhase::Impl::any_starts_warm() {
    for (std::size_t k = 0; k < slots->bucket_count(); ++k)
        if (slots->bucket(k).count > 0 && starts_warm(k)) return true;
    return false;
}

// Those from number `first` on.
void NarrowPhase::Impl::do_chunk(const Scene& scene, View<const Pair> pairs, std::size_t first) {
    const Stopwatch group;
    slots->group(pairs, *on_device, static_cast<std::uint32_t>(scene.row_count()), level != Level::Fast);
    stage_done();
    report.ms.buckets += group.ms();
    const Stopwatch routines;
    const std::size_t corner_bytes = any_starts_warm() ? pairs.size() * sizeof(WarmStart::Impl::Corners) : 0;
    if (corner_bytes > 0) {
        device().reserve(corners, corner_bytes, "the corners that pairs start from");
        device().write(corners, warm->corners.data() + first, corner_bytes);
    }
    for (std::size_t k = 0; k < slots->bucket_count(); ++k)
        if (slots->bucket(k).count > 0) do_bucket(scene, pairs, k);
    decide(scene, pairs);
    if (corner_bytes > 0) device().read(corners, warm->corners.data() + first, corner_bytes);
    stage_done();
    report.ms.routines += routines.ms();
    gather(scene, pairs);
}

void NarrowPhase::Impl::gather(const Scene& scene, View<const Pair> pairs) {
    const Stopwatch watch;
    const double manifolds_before = report.ms.manifolds;
    if (device().info().unified_memory && !(may_have_points() && !only_pairs))
        take_in_place(scene, pairs);
    else
        take_gathered(scene);
    report.ms.gather += watch.ms() - (report.ms.manifolds - manifolds_before);
}

void NarrowPhase::Impl::take_in_place(const Scene& scene, View<const Pair> pairs) {
    const SlotAnswers answers = slots->in_place(only_pairs);
    if (!only_pairs) {
        contacts.append(scene, pairs, answers);
        return;
    }
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (answers.is_hit(answers.slot_of(i))) touching.push_back(pairs[i]);
}

void NarrowPhase::Impl::take_gathered(const Scene& scene) {
    const std::uint32_t count = slots->gather(only_pairs);
    if (count == 0) return;
    const std::uint64_t stride = slots->contact_stride();
    const Mapping mapping =
        device().map(slots->contacts(), slots->gathered_columns(only_pairs) * stride * sizeof(std::uint32_t));
    const GatheredContacts gathered{mapping.as<std::uint32_t>(), stride, count, slots->rests()};
    if (only_pairs)
        for (std::size_t i = 0; i < count; ++i) touching.push_back({gathered.words[i], gathered.words[stride + i]});
    else if (may_have_points())
        append_points(scene, gathered);
    else
        contacts.append(scene, gathered);
}

// A sphere touches in one point.
bool NarrowPhase::Impl::may_have_points() const {
    if (options.contacts_per_pair == 1) return false;
    for (std::size_t k = 0; k < slots->bucket_count(); ++k)
        if (slots->bucket(k).count > 0 && matrix()[k].a != sphere_class) return true;
    return false;
}

// The manifolds of what slots.gather() left on the device.
void NarrowPhase::Impl::append_points(const Scene& scene, const GatheredContacts& gathered) {
    const Stopwatch watch;
    if (!manifolds) manifolds = std::make_unique<Manifolds>(device());
    const std::uint32_t wanted = options.contacts_per_pair;
    const unsigned bits = level == Level::Exact || options.tolerance ? 64 : 32;
    if (!manifolds->can(shapes, bits)) {
        const std::vector<FewPoints> points = manifolds_on_host(scene, shapes, answers_of(gathered), wanted);
        report.ms.manifolds += watch.ms();
        contacts.append(scene, gathered, points);
        return;
    }
    on_device->update(scene, shapes, bits);
    const ContactKinds kinds =
        kinds_of(scene, shapes, gathered.words, gathered.words + gathered.stride, gathered.count);
    DevicePoints points;
    manifolds->find(*on_device, *slots, kinds, gathered.rests, bits, wanted, points);
    report.ms.manifolds += watch.ms();
    contacts.append(scene, gathered, points);
}

const Plan& NarrowPhase::Impl::plan(std::size_t k) {
    std::optional<Plan>& plan = plans[k][only_pairs ? 1 : 0];
    if (plan) return *plan;
    NarrowPhaseOptions wanted = options;
    if (only_pairs) wanted.tolerance.reset();
    const MatrixRow& row = matrix()[k];
    plan = plan_of(row, wanted, wanted.tolerance ? largest_pair(shapes, row) : 1.0);
    return *plan;
}

// As a device's float64 has them, of the rows that have pairs.
RowTolerances NarrowPhase::Impl::host_tolerances() {
    RowTolerances tolerances{};
    for (std::size_t k = 0; k < report.buckets.size(); ++k)
        if (report.buckets[k].pairs > 0) tolerances[k] = static_cast<double>(static_cast<float>(plan(k).tolerance64));
    return tolerances;
}

// Whether the device is asked in float32 first.
bool NarrowPhase::Impl::in_float32(std::size_t k) {
    const MatrixRow& row = matrix()[k];
    const DeviceInfo& info = context.infos[context.primary()];
    const bool any_loops = most_loop_iterations(info) == std::numeric_limits<std::uint32_t>::max();
    return (level == Level::Fast || plan(k).passes != Passes::float64) && (row.lanes || any_loops);
}

void NarrowPhase::Impl::do_bucket(const Scene& scene, View<const Pair> pairs, std::size_t k) {
    const BucketSlice bucket = slots->bucket(k);
    const bool fp64 = context.infos[context.primary()].fp64;
    report.buckets[k].pairs += bucket.count;
    if (!in_float32(k)) {
        report.buckets[k].numbers = "float64";
        if (fp64)
            run_float64(scene, k, bucket);
        else
            run_on_host(scene, pairs, bucket);
        return;
    }
    if (options.tolerance) on_device->update(scene, shapes, 32);
    run(k, bucket, 32);
    report.buckets[k].numbers = level == Level::Fast ? "float32" : "float32, float64";
}

// What float32 has left undecided, in float64.
void NarrowPhase::Impl::decide(const Scene& scene, View<const Pair> pairs) {
    if (level == Level::Fast) return;
    const std::array<std::uint32_t, 32> open = slots->count_undecided();
    for (std::size_t k = 0; k < slots->bucket_count(); ++k) {
        if (open[k] == 0 || !in_float32(k)) continue;
        const BucketSlice again = slots->undecided(k, open[k]);
        report.buckets[k].again += open[k];
        // For a few the host is done before float64 kernels are built and fed.
        constexpr std::uint32_t few_pairs = 1024;
        if (context.infos[context.primary()].fp64 && open[k] > few_pairs)
            run_float64(scene, k, again);
        else
            run_on_host(scene, pairs, again);
    }
}

Kernel& NarrowPhase::Impl::kernel(std::size_t k, unsigned bits) {
    Kernel& kernel = kernels[k][bits == 64 ? 1 : 0][only_pairs ? 1 : 0][starts_warm(k) ? 1 : 0];
    if (kernel) return kernel;
    const MatrixRow& row = matrix()[k];
    const std::string defines = std::string(row.defines) + number_defines(context.infos[context.primary()], bits) +
                                (row.lanes ? "" : " -DPAIR_LANES=1") + (only_pairs ? " -DONLY_TOUCHING" : "") +
                                (starts_warm(k) ? " -DWARM_START" : "");
    kernel = device().kernel(row.module, "touch_pairs", defines);
    return kernel;
}

void NarrowPhase::Impl::run(std::size_t k, const BucketSlice& slice, unsigned bits) {
    constexpr std::uint32_t slot_block = Slots::block;
    const DeviceInfo& info = device().info();
    const std::uint32_t most_items = info.compute_units * (info.lanes > 1 ? 16u : 65536u);
    const std::uint32_t per_item = info.lanes > 1 ? ((slice.count - 1) / most_items / slot_block + 1) * slot_block
                                                  : (slice.count - 1) / most_items + 1;
    const std::uint32_t items = (slice.count - 1) / per_item + 1;
    // What nobody reads may be any buffer.
    const bool with_margins = on_device->has_margins();
    const Buffer& margins = with_margins ? on_device->margins() : on_device->classes();
    const float tolerance = options.tolerance && !only_pairs ? static_cast<float>(std::min(*options.tolerance, 3e38))
                                                             : std::numeric_limits<float>::infinity();
    const auto relative = static_cast<float>(bits == 64 ? plan(k).tolerance64 : plan(k).tolerance32);
    Kernel& touch = kernel(k, bits);
    touch.args(slots->pairs(), *slice.numbers, slice.listed ? 1u : 0u, slice.first, slice.count, per_item,
               on_device->bodies(bits), on_device->shapes(bits), on_device->vertices(bits), margins,
               with_margins ? 1u : 0u, slots->answers(), slots->stride(), slice.first_slot, tolerance, relative,
               slots->hits(), slots->undecided_counts(), static_cast<std::uint32_t>(k));
    if (starts_warm(k)) touch.args_from(19, corners);
    const std::size_t group = device().group_size();
    device().launch(touch, (items + group - 1) / group, group);
}

void NarrowPhase::Impl::run_on_host(const Scene& scene, View<const Pair> pairs, const BucketSlice& slice) {
    std::vector<Pair> again;
    again.reserve(slice.count);
    for (const std::uint32_t number : slots->numbers(slice)) again.push_back(pairs[number]);
    slots->put(slice, touch_on_host(scene, shapes, again, host_tolerances()));
}

NarrowPhase::NarrowPhase(Context& context, const NarrowPhaseOptions& options)
    : impl_(std::make_unique<Impl>(context, options)) {}
NarrowPhase::~NarrowPhase() = default;
NarrowPhase::NarrowPhase(NarrowPhase&& other) noexcept = default;
NarrowPhase& NarrowPhase::operator=(NarrowPhase&& other) noexcept = default;

View<const Contact> NarrowPhase::find(const Scene& scene, View<const Pair> pairs, WarmStart* warm) {
    impl_->find(scene, pairs, false, warm);
    return impl_->contacts.view();
}

View<const Pair> NarrowPhase::touching(const Scene& scene, View<const Pair> pairs, WarmStart* warm) {
    impl_->find(scene, pairs, true, warm);
    return impl_->touching;
}

const NarrowReport& NarrowPhase::report() const noexcept {
    return impl_->report;
}

}  // namespace clinch
