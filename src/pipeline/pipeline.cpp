#include "clinch/pipeline.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "src/device/failover.hpp"
#include "src/device/stopwatch.hpp"
#include "src/pipeline/pipeline_impl.hpp"
#include "src/scene/scene_impl.hpp"

namespace clinch {

namespace {

// Events are those of the pairs with planes, told here.
BroadPhaseOptions without_events(BroadPhaseOptions options) {
    options.events = false;
    return options;
}

void check_streaming(const PipelineOptions& options) {
    if (!options.streaming) return;
    const char* const lack = !options.contacts            ? "contacts"
                             : options.broad_phase.events ? "no events of pairs"
                             : options.warm_start         ? "no warm start"
                                                          : nullptr;
    if (lack != nullptr)
        throw Error(ErrorCode::InvalidArgument,
                    std::string("streaming keeps no pairs: it goes together with ") + lack + " only");
}

}  // namespace

StepResult::Impl::Impl(Context& context, const PipelineOptions& options)
    : broad(context, without_events(options.broad_phase)),
      measure(options.broad_phase.measure_stages),
      tell_events(options.broad_phase.events),
      starts_warm(options.warm_start),
      result(*this) {
    detail::check_options(context.impl(), options.broad_phase);
    check_streaming(options);
    if (options.contacts) narrow.emplace(context, options.narrow_phase);
    if (options.streaming) phases = std::make_unique<detail::PhaseStream>(context, options.broad_phase, narrow->impl());
}

void StepResult::Impl::start_afresh() {
    device_bounds.reset();
    host_bounds.reset();
    pairs = {};
    contacts = {};
    narrow_report = {};
    kept.clear();
    merged.clear();
    boxes_read.reset();
    rows = 0;
    on_device = false;
    scene_identity.reset();
    stepped_identity.reset();
}

void StepResult::Impl::leave_bounds() {
    device_bounds.reset();
    planes = detail::PlanePairs();
}

// The filters of a scene, under a number that changes when they may have.
detail::FilterInput StepResult::Impl::filters(const Scene& scene) {
    filters_changed = false;
    if (scene.impl().filters_default()) return {};
    if (scene_identity != scene.impl().identity || scene_filter_version != scene.filter_version()) {
        scene_identity = scene.impl().identity;
        scene_filter_version = scene.filter_version();
        ++filter_version;
        filters_changed = true;
    }
    const SceneColumns columns = scene.columns();
    return {{columns.group.data(), columns.mask.data(), columns.motion.data()}, filter_version};
}

// Makes the boxes of all rows on the primary device; how many rows had changed.
std::size_t StepResult::Impl::make_boxes_on_device(const Scene& scene) {
    detail::Device& device = broad.impl().device();
    if (device_bounds && &device_bounds->device() != &device) leave_bounds();  // that device was retired
    if (!device_bounds) device_bounds.emplace(device);
    const detail::Stopwatch upload;
    const std::size_t changed = device_bounds->upload(scene);
    if (measure) device.finish();
    report.ms.upload = upload.ms();
    const detail::Stopwatch bounds;
    device_bounds->compute();
    if (measure) device.finish();
    report.ms.bounds = bounds.ms();
    return changed;
}

std::size_t StepResult::Impl::make_boxes_on_host(const Scene& scene) {
    if (!host_bounds) host_bounds.emplace();
    const detail::Stopwatch bounds;
    const std::size_t changed = host_bounds->update(scene);
    report.ms.bounds = bounds.ms();
    return changed;
}

void StepResult::Impl::make_boxes(const Scene& scene) {
    const std::size_t changed = on_device ? make_boxes_on_device(scene) : make_boxes_on_host(scene);
    report.skipped.bounds = rows - std::min(rows, changed);
}

// The pairs of the boxes on the device, by what the last upload changed if that pays.
View<const Pair> StepResult::Impl::find_changed(const detail::AlgorithmRow& row, const detail::FilterInput& filters) {
    BroadPhase::Impl& impl = broad.impl();
    const View<const std::uint32_t> sent = device_bounds->sent();
    detail::BoxInput input(device_bounds->device(), device_bounds->boxes().handle(), 0,
                           static_cast<std::uint32_t>(rows));
    if (impl.listed_boxes == rows && stepped_rows == rows) {
        if (sent.empty() && !filters_changed) return impl.same_again();
        if (impl.steps_pay(row, rows, sent.size())) {
            if (impl.step(input, {sent, nullptr, filters_changed}, filters)) return impl.pairs.view();
            return impl.find_to_step(row, input, filters, false);
        }
    }
    return impl.find(row, input, filters, false);
}

// Planes have no box: their pairs are found here, and told in the report.
const std::vector<Pair>& StepResult::Impl::find_plane_pairs(const Scene& scene) {
    static const std::vector<Pair> none;
    const auto& plane_rows = scene.impl().plane_rows();
    if (plane_rows.empty()) return none;
    const detail::Stopwatch watch;
    const std::vector<detail::WorldPlane> in_world = detail::world_planes(scene, plane_rows);
    detail::FindCounts counts;
    const std::vector<Pair>& found = on_device ? planes.find(device_bounds->device(), in_world, device_bounds->boxes(),
                                                             static_cast<std::uint32_t>(rows), filters(scene), counts)
                                               : planes.find(in_world, host_bounds->boxes(), filters(scene), counts);
    report.skipped.pairs_filtered += counts.pairs_filtered;
    report.skipped.static_pairs += counts.static_pairs;
    report.ms.broad += watch.ms();
    return found;
}

void StepResult::Impl::add_plane_pairs(const Scene& scene) {
    const std::vector<Pair>& found = find_plane_pairs(scene);
    if (found.empty()) return;
    const detail::Stopwatch watch;
    merged.resize(pairs.size() + found.size());
    std::merge(pairs.begin(), pairs.end(), found.begin(), found.end(), merged.begin());
    detail::check_limit(merged.size(), broad.impl().options);
    pairs = merged;
    report.ms.broad += watch.ms();
}

bool StepResult::Impl::nothing_changed(const Scene& scene) const {
    return stepped_identity != nullptr && stepped_identity == scene.impl().identity &&
           stepped_version == scene.version();
}

void StepResult::Impl::take_contacts() {
    narrow_report = narrow->report();
    report.contacts = contacts.size();
    report.warnings.insert(report.warnings.end(), narrow_report.warnings.begin(), narrow_report.warnings.end());
    report.tolerance_missed = narrow_report.tolerance_missed;
    report.ms.narrow = narrow_report.ms.total;
    report.peak_device_bytes = std::max(report.peak_device_bytes, narrow_report.peak_device_bytes);
    most_contacts = std::max(most_contacts, report.contacts);
    report.peak_host_bytes += most_contacts * sizeof(Contact);
}

// The last step's result once more.
void StepResult::Impl::step_again() {
    report.ms = {};
    narrow_report.ms = {};
    report.box_tests = 0;
    report.skipped = {};
    report.skipped.bounds = rows;
    report.skipped.unchanged = rows;
    report.broad_split.clear();
    report.stream = {};
    report.warnings.clear();
    events.same_again();
}

void StepResult::Impl::step(const Scene& scene) {
    const detail::Stopwatch total;
    if (nothing_changed(scene)) {
        step_again();
        report.ms.total = total.ms();
        return;
    }
    broad.impl().settle();
    pairs = {};
    contacts = {};
    boxes_read.reset();
    rows = scene.row_count();
    report = Report{};
    report.rejected = scene.rejected();
    const detail::AlgorithmRow& row = broad.impl().choose(rows);
    on_device = row.needs_device;
    report.bodies = scene.body_count();
    if (phases) {
        find_streamed(scene, row);
    } else {
        make_boxes(scene);
        find_listed(scene, row);
    }
    if (tell_events) events.update(pairs);  // last, since a step that fails counts for none
    stepped_identity = scene.impl().identity;
    stepped_version = scene.version();
    stepped_rows = rows;
    report.ms.total = total.ms();
}

// The pairs, then their contacts.
void StepResult::Impl::find_listed(const Scene& scene, const detail::AlgorithmRow& row) {
    if (on_device) {
        pairs = find_changed(row, filters(scene));
    } else {
        detail::BoxInput input(host_bounds->boxes(), broad.impl().staging);
        pairs = broad.impl().find(row, input, filters(scene), false);
    }
    const Report& found = broad.report();
    report.algorithm = found.algorithm;
    report.box_tests = found.box_tests;
    const std::uint64_t bounds_skipped = report.skipped.bounds;
    report.skipped = found.skipped;
    report.skipped.bounds = bounds_skipped;
    report.ms.broad = found.ms.broad;
    report.ms.download = found.ms.download;
    report.broad_split = found.broad_split;
    report.warnings = found.warnings;
    report.peak_device_bytes = found.peak_device_bytes;
    report.peak_host_bytes = found.peak_host_bytes;
    add_plane_pairs(scene);
    report.pairs = pairs.size();
    if (!narrow) return;
    contacts = narrow->find(scene, pairs, starts_warm ? &kept : nullptr);
    take_contacts();
}

// What a streamed step begins with.
detail::PhaseStream::Prepared StepResult::Impl::prepare(const Scene& scene) {
    make_boxes(scene);
    const std::vector<Pair>& with_planes = find_plane_pairs(scene);
    return {on_device ? detail::BoxInput(device_bounds->device(), device_bounds->boxes().handle(), 0,
                                         static_cast<std::uint32_t>(rows))
                      : detail::BoxInput(host_bounds->boxes(), broad.impl().staging),
            filters(scene), with_planes};
}

// Pairs on their way to contacts; none is kept.
void StepResult::Impl::find_streamed(const Scene& scene, const detail::AlgorithmRow& row) {
    const detail::PhaseStream::Done done = phases->run({scene, row, [&] { return prepare(scene); }});
    contacts = narrow->impl().result.contacts.view();
    broad.impl().report.bodies = rows;  // for the choice of the next step
    broad.impl().report.pairs = done.pairs - done.more_pairs;
    broad.impl().note_memory();
    report.peak_host_bytes = broad.report().peak_host_bytes;
    take_contacts();
    report.algorithm = row.name;
    report.pairs = done.pairs;
    report.box_tests = done.counts.box_tests;
    report.skipped.inside = done.counts.boxes_inside;
    report.skipped.still = done.counts.still;
    report.skipped.pairs_filtered += done.counts.pairs_filtered;
    report.skipped.static_pairs += done.counts.static_pairs;
    report.stream = done.work;
    report.broad_split = done.broad_split;
    report.ms.broad += done.broad_ms;
    report.ms.narrow = narrow_report.ms.total = done.narrow_ms;
    report.peak_host_bytes += done.work.pair_bytes;
}

View<const Aabb> StepResult::Impl::boxes() {
    if (!on_device) return host_bounds ? host_bounds->boxes() : View<const Aabb>{};
    if (!boxes_read) {
        std::vector<Aabb> read(rows);
        device_bounds->device().read(device_bounds->boxes(), read.data(), rows * sizeof(Aabb));
        boxes_read = std::move(read);
    }
    return *boxes_read;
}

View<const Pair> StepResult::pairs() const {
    return impl_->pairs;
}
View<const Pair> StepResult::added() const noexcept {
    return impl_->events.added();
}
View<const Pair> StepResult::removed() const noexcept {
    return impl_->events.removed();
}
View<const Aabb> StepResult::boxes() const {
    return impl_->boxes();
}
View<const Contact> StepResult::contacts() const noexcept {
    return impl_->contacts;
}
const NarrowReport& StepResult::narrow_report() const noexcept {
    return impl_->narrow_report;
}
const Report& StepResult::report() const noexcept {
    return impl_->report;
}

Pipeline::Pipeline(Context& context, const PipelineOptions& options)
    : impl_(std::make_unique<StepResult::Impl>(context, options)) {}
Pipeline::~Pipeline() = default;
Pipeline::Pipeline(Pipeline&& other) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&& other) noexcept = default;

void Pipeline::drop_warm_start() noexcept {
    impl_->kept.clear();
}

const StepResult& Pipeline::step(const Scene& scene) {
    StepResult::Impl& impl = *impl_;
    std::vector<std::string> warnings;
    try {
        detail::with_failover(
            impl.broad.impl().context, warnings, [&] { impl.step(scene); },
            [&] {
                impl.start_afresh();
                impl.leave_bounds();
            });
    } catch (...) {
        impl.start_afresh();
        throw;
    }
    impl.report.warnings.insert(impl.report.warnings.begin(), warnings.begin(), warnings.end());
    return impl.result;
}

}  // namespace clinch
