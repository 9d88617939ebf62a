#include "clinch/narrow_phase.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "clinch/error.hpp"
#include "src/device/stopwatch.hpp"
#include "src/narrow_phase/contact_list.hpp"
#include "src/narrow_phase/host_narrow.hpp"
#include "src/narrow_phase/matrix.hpp"
#include "src/narrow_phase/narrow_phase_impl.hpp"

namespace clinch {
namespace {

using namespace detail;

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

NarrowPhase::Impl::Impl(Context& c, const NarrowPhaseOptions& o)
    : context(c.impl()), settings(o), devices(context, settings) {
    check_options(o);
}

bool NarrowPhase::Impl::worth_a_device(std::size_t pairs) const {
    if (context.infos.empty() || pairs < few_pairs) return false;
    return context.infos[context.primary()].fp64 || settings.level != Level::Exact;
}

void NarrowPhase::Impl::begin(const Scene& scene) {
    result.clear();
    report = NarrowReport{};
    for (const MatrixRow& row : matrix()) report.buckets.push_back({classes_text(row), row.module, {}, 0, 0});
    const Stopwatch upload;
    if (settings.shapes.update(scene)) {
        settings.plans.shapes_changed();
        devices.shapes_changed();  // also where this call has no need of them
    }
    report.ms.upload = upload.ms();
}

void NarrowPhase::Impl::find(const Scene& scene, View<const Pair> pairs, bool touching_only, WarmStart* from) {
    const Stopwatch total;
    begin(scene);
    report.pairs = pairs.size();
    try {
        find_somewhere({scene, pairs, touching_only, from != nullptr ? &from->impl() : nullptr});
    } catch (...) {
        result.clear();
        if (from != nullptr) from->clear();
        devices.forget();
        throw;
    }
    finish_report(touching_only);
    report.ms.total = total.ms();
}

// Once more for as long as devices fail and others are left.
void NarrowPhase::Impl::find_somewhere(const NarrowCall& call) {
    bool taken = false;  // what is kept of the pairs
    while (worth_a_device(call.pairs.size())) {
        const Stopwatch upload;
        if (call.warm != nullptr)
            report.warm = taken ? call.warm->restore(0, call.pairs.size()) : call.warm->take(call.pairs);
        taken = true;
        report.ms.upload += upload.ms();
        if (devices.find(call, result, report)) return;
        result.clear();
    }
    if (taken && call.warm != nullptr) call.warm->restore(0, call.pairs.size());
    report.warm = 0;
    find_on_host({call.scene, call.pairs, call.only_pairs, nullptr}, result);
}

void NarrowPhase::Impl::finish_report(bool touching_only) {
    report.contacts = result.size(touching_only);
    if (settings.options.tolerance) report.tolerance_missed = count_above(result.contacts, *settings.options.tolerance);
    const auto is_empty = [](const BucketReport& bucket) { return bucket.pairs == 0; };
    report.cells_skipped =
        static_cast<std::uint64_t>(std::count_if(report.buckets.begin(), report.buckets.end(), is_empty));
    report.buckets.erase(std::remove_if(report.buckets.begin(), report.buckets.end(), is_empty), report.buckets.end());
    for (const auto& opened : context.devices)
        if (opened != nullptr) report.peak_device_bytes += opened->report().peak_bytes;
}

void NarrowPhase::Impl::find_on_host(const NarrowCall& call, NarrowResult& to) {
    const Stopwatch watch;
    RowTolerances tolerances{};
    for (const Pair& pair : call.pairs) {
        const MatrixRow* const row = row_of(call.scene, settings.shapes, pair);
        if (row == nullptr) throw_no_routine(pair);
        const auto k = static_cast<std::size_t>(row - matrix().data());
        BucketReport& bucket = report.buckets[k];
        if (++bucket.pairs > 1) continue;
        bucket.numbers = "float64";
        tolerances[k] = settings.plans.host_tolerance(k, call.only_pairs);
    }
    ChunkContacts chunk;
    for (std::size_t first = 0; first < call.pairs.size(); first += Slots::chunk_pairs) {
        const View<const Pair> pairs{call.pairs.data() + first,
                                     std::min(Slots::chunk_pairs, call.pairs.size() - first)};
        std::vector<HostAnswer> answers = touch_on_host(call.scene, settings.shapes, pairs, tolerances);
        std::vector<FewPoints> points;
        if (!call.only_pairs && settings.options.contacts_per_pair > 1)
            points = manifolds_on_host(call.scene, settings.shapes, answers, settings.options.contacts_per_pair);
        chunk.take(std::move(answers), std::move(points));
        to.append(call, chunk);
    }
    report.ms.routines += watch.ms();
}

NarrowPhase::NarrowPhase(Context& context, const NarrowPhaseOptions& options)
    : impl_(std::make_unique<Impl>(context, options)) {}
NarrowPhase::~NarrowPhase() = default;
NarrowPhase::NarrowPhase(NarrowPhase&& other) noexcept = default;
NarrowPhase& NarrowPhase::operator=(NarrowPhase&& other) noexcept = default;

View<const Contact> NarrowPhase::find(const Scene& scene, View<const Pair> pairs, WarmStart* warm) {
    impl_->find(scene, pairs, false, warm);
    return impl_->result.contacts.view();
}

View<const Pair> NarrowPhase::touching(const Scene& scene, View<const Pair> pairs, WarmStart* warm) {
    impl_->find(scene, pairs, true, warm);
    return impl_->result.touching.view();
}

const NarrowReport& NarrowPhase::report() const noexcept {
    return impl_->report;
}

}  // namespace clinch
