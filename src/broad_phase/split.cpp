#include "src/broad_phase/split.hpp"

#include <algorithm>
#include <atomic>
#include <functional>
#include <limits>
#include <map>
#include <mutex>
#include <numeric>
#include <utility>

#include "src/broad_phase/slab_merge.hpp"
#include "src/broad_phase/slab_worker.hpp"
#include "src/device/crew.hpp"
#include "src/device/stopwatch.hpp"

namespace clinch::detail {
namespace {

// Less than this, by the boxes that several devices have, does not pay.
constexpr double least_speed_up = 1.3;

std::vector<double> guesses_of(const Context::Impl& context) {
    std::vector<double> guesses;
    for (const DeviceInfo& info : context.infos) guesses.push_back(guessed_speed(info));
    return guesses;
}

bool is_limit(const std::exception_ptr& thrown) {
    try {
        std::rethrow_exception(thrown);
    } catch (const Error& error) {
        return error.code() == ErrorCode::LimitExceeded;
    } catch (...) {
        return false;
    }
}

// Joins the progress of slabs, and stops all when one has failed for good.
class Progress {
public:
    struct Stopped {};
    Progress(const std::function<void(double)>& tell, std::size_t slabs) : tell_(tell), done_(slabs, 0.0) {}
    void stop() noexcept { stopped_ = true; }
    // What slab i calls with the share of it that is done.
    std::function<void(double)> of(std::size_t i) {
        return [this, i](double done) {
            if (stopped_) throw Stopped{};
            if (!tell_) return;
            const std::lock_guard<std::mutex> lock(mutex_);
            done_[i] = done;
            tell_(std::accumulate(done_.begin(), done_.end(), 0.0) / static_cast<double>(done_.size()));
        };
    }

private:
    const std::function<void(double)>& tell_;
    std::vector<double> done_;
    std::mutex mutex_;
    std::atomic<bool> stopped_{false};
};

}  // namespace

BroadSplit::BroadSplit(Context::Impl& context, const BroadPhaseOptions& options)
    : context_(context), options_(options), shares_(guesses_of(context)) {}
BroadSplit::~BroadSplit() = default;

std::vector<std::size_t> BroadSplit::crew_for(const AlgorithmRow& row, std::uint64_t count) const {
    std::vector<std::size_t> crew;
    for (const std::size_t device : context_.crew()) {
        const bool has_share = !forced_.empty() || shares_.fractions()[device] > 0.0;
        if (has_share && runs_on(row, context_.infos[device])) crew.push_back(device);
    }
    const std::uint64_t most = count / std::max<std::uint64_t>(1, context_.least_boxes_a_device);
    crew.resize(static_cast<std::size_t>(std::min<std::uint64_t>({crew.size(), most, Slabs::most})));
    return crew;
}

std::vector<double> BroadSplit::fractions_of(const std::vector<std::size_t>& crew) const {
    std::vector<double> fractions;
    for (std::size_t k = 0; k < crew.size(); ++k)
        fractions.push_back(forced_.empty() ? shares_.fractions()[crew[k]] : k < forced_.size() ? forced_[k] : 0.0);
    const double sum = std::accumulate(fractions.begin(), fractions.end(), 0.0);
    for (double& fraction : fractions)
        fraction = sum > 0.0 ? fraction / sum : 1.0 / static_cast<double>(fractions.size());
    return fractions;
}

bool BroadSplit::pays(const AlgorithmRow& row, std::uint64_t count) const {
    return row.needs_device && context_.infos.size() > 1 && crew_for(row, count).size() > 1;
}

// A worker a slab, with its device.
void BroadSplit::prepare(const std::vector<std::size_t>& crew) {
    while (workers_.size() < crew.size()) workers_.push_back(std::make_unique<SlabWorker>(context_, options_));
    workers_.resize(crew.size());
    for (std::size_t s = 0; s < crew.size(); ++s) {
        workers_[s]->assign(crew[s]);
        workers_[s]->options().max_pairs = options_.max_pairs;
    }
}

// Gives each of the crew a slab. False if it does not pay.
bool BroadSplit::deal(View<const Aabb> boxes, const std::vector<std::size_t>& crew) {
    const std::vector<double> fractions = fractions_of(crew);
    const Slabs slabs = choose_slabs(boxes, fractions);
    if (forced_.empty() && crew.size() > 1 && static_cast<double>(crew.size()) < least_speed_up * (1.0 + slabs.copies))
        return false;
    dealt_to_.clear();  // until all went well
    deal_.deal(boxes, slabs);
    dealt_to_ = crew;
    dealt_ = fractions;
    return true;
}

// The slabs for this call, and workers for them: those of the last one if they still have the right shares and all
// boxes stay in those that they are members of. With `send` the boxes are in the workers' room. False if it does not
// pay.
bool BroadSplit::settle(const AlgorithmRow& row, View<const Aabb> boxes, const std::vector<std::size_t>& crew,
                        bool send) {
    prepare(crew);
    const bool same = crew == dealt_to_ && shares_.may_stay(dealt_, fractions_of(crew));
    if (same && keep(row, boxes, send)) return true;
    if (!deal(boxes, crew)) return false;
    if (send) keep(row, boxes, true);
    return true;
}

// Whether all boxes stay in slabs that they are members of; with `send` the host's threads put them, in the same pass,
// where the devices find them. One pass for all: each device alone would read nearly all memory that boxes are in.
bool BroadSplit::keep(const AlgorithmRow& row, View<const Aabb> boxes, bool send) {
    std::vector<Aabb*> rows(workers_.size(), nullptr);
    if (send) {
        const auto make_room = [&](std::size_t s) { rows[s] = workers_[s]->room_for(deal_.members(s).size()); };
        const std::vector<std::exception_ptr> not_begun = run_crew(rows.size(), make_room);
        for (std::size_t s = 0; s < rows.size(); ++s)
            if (not_begun[s] != nullptr) make_room(s);  // there was no thread to be had
    }
    return deal_.keep(boxes, rows, !row.in_range);
}

void BroadSplit::start_call() {
    warnings_.clear();
    for (std::size_t d = 0; d < context_.infos.size(); ++d)
        if (!context_.in_use(d)) shares_.retire(d);
}

bool BroadSplit::find(const AlgorithmRow& row, BoxInput& boxes, const FilterInput& filters, PairList& pairs,
                      FindCounts& counts) {
    start_call();
    const std::vector<std::size_t> crew = crew_for(row, boxes.count());
    const View<const Aabb> on_host = boxes.on_host();
    if (!settle(row, on_host, crew, row.in_range || !pairs.counts_only())) return false;
    const SlabTask task{row, on_host, filters, deal_, pairs.counts_only(), keys_for(boxes.count())};
    run(task);
    measure();
    gather(task.counts_only, pairs, counts);
    check_limit(pairs.size(), options_);
    return true;
}

// The keys that suit the longest list of the last call, or at first, so many pairs a box; none if not all devices have
// them: then pairs are what can be merged at once.
std::optional<KeyLayout> BroadSplit::keys_for(std::uint64_t boxes) const {
    constexpr std::uint64_t guessed_pairs_a_box = 8;
    const DeviceInfo* widest = nullptr;
    std::uint64_t most = 0;
    for (const auto& worker : workers_) {
        const DeviceInfo& info = context_.infos[worker->device()];
        if (!PairSort::packs_on(info)) return std::nullopt;
        if (widest == nullptr || info.compute_units > widest->compute_units) widest = &info;
        most = std::max(most, worker->found());
    }
    if (widest == nullptr) return std::nullopt;
    return PairSort::layout_for(most > 0 ? most : boxes * guessed_pairs_a_box, static_cast<std::uint32_t>(boxes),
                                *widest);
}

// All slabs; those of a device that fails once more, on others.
void BroadSplit::run(const SlabTask& task) {
    std::vector<std::size_t> which(workers_.size());
    std::iota(which.begin(), which.end(), 0);
    while (!which.empty()) {
        const std::vector<std::exception_ptr> thrown = run_once(task, which);
        for (const std::exception_ptr& error : thrown) {
            if (error == nullptr || is_device_fault(error)) continue;
            if (is_limit(error)) throw_limit(task);
            std::rethrow_exception(error);
        }
        which = reassign(task.row, which, thrown);
    }
}

// All slabs, each on its device or not at all.
void BroadSplit::run_in_place(const SlabTask& task) {
    std::vector<std::size_t> which(workers_.size());
    std::iota(which.begin(), which.end(), 0);
    const std::vector<std::exception_ptr> thrown = run_once(task, which);
    for (std::size_t s = 0; s < thrown.size(); ++s)
        if (thrown[s] != nullptr && is_device_fault(thrown[s])) throw DeviceFault{workers_[s]->device(), thrown[s]};
    for (const std::exception_ptr& error : thrown) {
        if (error == nullptr) continue;
        if (is_limit(error)) throw_limit(task);
        std::rethrow_exception(error);
    }
}

// Some of the slabs, each device those it has, one after the other. What each slab threw.
std::vector<std::exception_ptr> BroadSplit::run_once(const SlabTask& task, const std::vector<std::size_t>& which) {
    std::map<std::size_t, std::vector<std::size_t>> of_device;  // places in `which`
    for (std::size_t i = 0; i < which.size(); ++i) of_device[workers_[which[i]]->device()].push_back(i);
    std::vector<std::vector<std::size_t>> lists;
    lists.reserve(of_device.size());
    for (auto& [device, list] : of_device) lists.push_back(std::move(list));
    std::vector<std::exception_ptr> thrown(which.size());
    Progress progress(options_.progress, which.size());
    const auto work = [&](std::size_t k) {
        for (const std::size_t i : lists[k]) {
            SlabWorker& worker = *workers_[which[i]];
            worker.options().progress = progress.of(i);
            try {
                worker.find(task, which[i]);
            } catch (const Progress::Stopped&) {
                // Another one's failure ends the call.
            } catch (...) {
                thrown[i] = std::current_exception();
                if (!is_device_fault(thrown[i])) progress.stop();
            }
            worker.options().progress = nullptr;
        }
    };
    const std::vector<std::exception_ptr> not_begun = run_crew(lists.size(), work);
    for (std::size_t k = 0; k < lists.size(); ++k)
        if (not_begun[k] != nullptr) work(k);  // there was no thread to be had
    return thrown;
}

// Retires the devices that failed and gives their slabs to others. Returns the slabs that are to be done again.
std::vector<std::size_t> BroadSplit::reassign(const AlgorithmRow& row, const std::vector<std::size_t>& which,
                                              const std::vector<std::exception_ptr>& thrown) {
    std::vector<std::size_t> again;
    for (std::size_t i = 0; i < which.size(); ++i) {
        if (thrown[i] == nullptr) continue;
        again.push_back(which[i]);
        const std::size_t device = workers_[which[i]]->device();
        if (!context_.in_use(device)) continue;
        if (!context_.retire(device, message_of(thrown[i]))) std::rethrow_exception(thrown[i]);
        shares_.retire(device);
        warnings_.push_back(context_.why_retired(device));
    }
    if (again.empty()) return again;
    std::vector<std::size_t> left;
    for (const std::size_t device : context_.crew())
        if (runs_on(row, context_.infos[device])) left.push_back(device);
    if (left.empty())
        std::rethrow_exception(*std::find_if(thrown.begin(), thrown.end(), [](const auto& e) { return e != nullptr; }));
    for (std::size_t i = 0; i < again.size(); ++i) workers_[again[i]]->assign(left[i % left.size()]);
    return again;
}

// More pairs than are allowed: how many there are.
void BroadSplit::throw_limit(const SlabTask& task) {
    for (const auto& worker : workers_) {
        worker->forget_pairs();
        worker->options().max_pairs = std::numeric_limits<std::uint64_t>::max();
    }
    const SlabTask counting{task.row, task.boxes, task.filters, task.deal, true, std::nullopt};
    if (task.taker != nullptr)
        run_in_place(counting);
    else
        run(counting);
    std::uint64_t pairs = 0;
    for (const auto& worker : workers_) pairs += worker->counted();
    check_limit(pairs, options_);
    throw Error(ErrorCode::LimitExceeded, "more pairs were found than are allowed (max_pairs)");
}

void BroadSplit::add_counts(FindCounts& counts) const {
    for (const auto& worker : workers_) {
        const FindCounts& found = worker->counts();
        counts.box_tests += found.box_tests;
        counts.pairs_filtered += found.pairs_filtered;
        counts.static_pairs += found.static_pairs;
        counts.still += found.still;
        counts.boxes_inside += found.boxes_inside;
        counts.invalid_boxes = counts.invalid_boxes || found.invalid_boxes;
    }
}

void BroadSplit::begin_stream(const AlgorithmRow& row, BoxInput& boxes, std::vector<std::size_t> crew) {
    start_call();
    if (crew.empty()) crew = crew_for(row, boxes.count());
    const View<const Aabb> on_host = boxes.on_host();
    if (settle(row, on_host, crew, false)) return;
    crew.resize(1);
    settle(row, on_host, crew, false);
}

std::uint64_t BroadSplit::stream(const AlgorithmRow& row, BoxInput& boxes, const FilterInput& filters,
                                 const PairTaker& taker, FindCounts& counts) {
    const View<const Aabb> on_host = boxes.on_host();
    const SlabTask task{row, on_host, filters, deal_, false, std::nullopt, &taker};
    keep(row, on_host, true);
    run_in_place(task);
    measure();
    add_counts(counts);
    std::uint64_t pairs = 0;
    for (const auto& worker : workers_) pairs += worker->found();
    check_limit(pairs, options_);
    return pairs;
}

void BroadSplit::gather(bool counts_only, PairList& pairs, FindCounts& counts) {
    add_counts(counts);
    SlabLists lists;
    for (const auto& worker : workers_) {
        if (counts_only) pairs.add_count(worker->counted());
        lists.push_back(worker->pairs());
    }
    if (counts_only) return;
    const Stopwatch watch;
    merge_slabs(deal_, lists, options_.order == Order::Sorted, pairs);
    counts.download_ms += watch.ms();
}

std::vector<DeviceWork> BroadSplit::work() const {
    std::vector<DeviceWork> work;
    for (std::size_t s = 0; s < workers_.size(); ++s)
        work.push_back(
            {workers_[s]->device(), deal_.members(s).size(), workers_[s]->found(), workers_[s]->seconds() * 1e3});
    return work;
}

void BroadSplit::measure() {
    if (!warnings_.empty()) return;
    std::vector<Shares::Measure> measures(context_.infos.size());
    for (std::size_t s = 0; s < workers_.size(); ++s) {
        const std::size_t device = workers_[s]->device();
        // What was dealt, not what became of it: boxes that reach over a cut are as many however much a device has.
        const double work = dealt_[s] * static_cast<double>(deal_.boxes());
        if (work > 0.0) measures[device] = {work, workers_[s]->seconds()};
    }
    shares_.measured(std::move(measures));
}

void BroadSplit::forget_pairs() {
    for (const auto& worker : workers_) worker->forget_pairs();
}

}  // namespace clinch::detail
