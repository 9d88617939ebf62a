#include "src/narrow_phase/narrow_devices.hpp"

#include <algorithm>
#include <string>

#include "src/device/crew.hpp"
#include "src/device/stopwatch.hpp"
#include "src/narrow_phase/contact_list.hpp"
#include "src/narrow_phase/narrow_split.hpp"

namespace clinch::detail {
namespace {

// Of a call that is split, each device has at least so many: what it costs to begin is spread over them, and there is
// something left to take over.
constexpr std::size_t least_chunks = 2;

}  // namespace

void NarrowDevices::shapes_changed() noexcept {
    for (const auto& member : members_)
        if (member) member->worker().shapes_changed();
}

void NarrowDevices::forget() {
    for (const auto& member : members_)
        if (member) member->worker().forget();
}

// What belongs to devices that are not used any more is given back.
void NarrowDevices::start_call() {
    members_.resize(context_.infos.size());
    for (std::size_t i = 0; i < members_.size(); ++i) {
        if (!context_.in_use(i)) members_[i].reset();
        if (members_[i]) members_[i]->start_call();
    }
}

NarrowMember& NarrowDevices::member(std::size_t device) {
    if (!members_[device]) members_[device] = std::make_unique<NarrowMember>(context_.open(device), settings_);
    return *members_[device];
}

// The primary device and those that give the same answers.
std::vector<std::size_t> NarrowDevices::alike() const {
    std::vector<std::size_t> devices = context_.crew();
    const DeviceInfo& primary = context_.infos[devices.front()];
    devices.erase(std::remove_if(devices.begin(), devices.end(),
                                 [&](std::size_t i) { return !same_answers(primary, context_.infos[i]); }),
                  devices.end());
    return devices;
}

// Those that a call of so many chunks is worth, the fastest first; never none.
std::vector<std::size_t> NarrowDevices::crew_for(std::size_t chunks) {
    const std::size_t most = std::max<std::size_t>(1, chunks / least_chunks);
    if (most == 1) return {context_.primary()};
    std::vector<std::size_t> devices = alike();
    if (devices.size() == 1) {
        shares_.reset();
        sharing_.clear();
        return devices;
    }
    if (devices != sharing_) {
        std::vector<double> guesses;
        guesses.reserve(devices.size());
        for (const std::size_t i : devices) guesses.push_back(guessed_speed(context_.infos[i]));
        shares_.emplace(guesses);
        sharing_ = devices;
        measured_chunks_ = 0;
    }
    std::vector<std::size_t> crew;  // places in sharing_
    for (std::size_t k = 0; k < devices.size(); ++k)
        if (!fractions.empty() || shares_->fractions()[k] > 0.0) crew.push_back(k);
    if (fractions.empty())
        std::stable_sort(crew.begin(), crew.end(), [&](std::size_t p, std::size_t q) {
            return shares_->fractions()[p] > shares_->fractions()[q];
        });
    crew.resize(std::min(crew.size(), most));
    for (std::size_t& k : crew) k = devices[k];
    return crew;
}

std::vector<ChunkQueue::Taker> NarrowDevices::takers_for(const std::vector<std::size_t>& crew,
                                                         std::size_t chunks) const {
    std::vector<ChunkQueue::Taker> takers;
    for (std::size_t k = 0; k < crew.size(); ++k) {
        if (!fractions.empty()) {
            takers.push_back({fractions[k % fractions.size()]});
            continue;
        }
        const auto place =
            static_cast<std::size_t>(std::find(sharing_.begin(), sharing_.end(), crew[k]) - sharing_.begin());
        const Shares::Estimate estimate = shares_->estimate(place);
        const std::size_t measured = measured_chunks_ > 0 ? measured_chunks_ : chunks;
        takers.push_back({shares_->fractions()[place], estimate.seconds_for_all / static_cast<double>(measured),
                          estimate.seconds_to_begin});
    }
    return takers;
}

bool NarrowDevices::find(const NarrowCall& call, NarrowResult& result, NarrowReport& report) {
    start_call();
    const std::size_t chunks = (call.pairs.size() + chunk_pairs - 1) / chunk_pairs;
    const std::vector<std::size_t> crew = crew_for(chunks);
    std::vector<Failure> failures;
    bool done = false;
    if (crew.size() > 1) {
        done = find_on_several(call, crew, result, failures, report);
    } else {
        try {
            find_on_one(call, crew.front(), result);
            add_to(report, crew.front(), 0);
            done = true;
        } catch (...) {
            if (!is_device_fault(std::current_exception())) throw;
            failures.push_back({crew.front(), std::current_exception()});
        }
    }
    if (done) {
        const Stopwatch finish;
        if (any_margins()) drop_beyond_margins(call.scene, result.contacts);
        report.ms.gather += finish.ms();
    }
    if (!failures.empty())
        retire(failures, done, report);
    else if (shares_ && fractions.empty() && chunks >= 2 * least_chunks)
        learn(chunks);
    return done;
}

bool NarrowDevices::any_margins() const {
    return std::any_of(members_.begin(), members_.end(), [](const auto& member) {
        return member && member->worker().began() && member->worker().scene().has_margins();
    });
}

std::vector<std::size_t> NarrowDevices::begin_stream() {
    start_call();
    return alike();
}

void NarrowDevices::prepare_stream(std::size_t device, const NarrowCall& call) {
    NarrowWorker& worker = member(device).worker();
    worker.timed([&] { worker.begin(call); });
}

std::pair<std::size_t, std::size_t> NarrowDevices::find_streamed(std::size_t device, const NarrowCall& call,
                                                                 std::atomic<std::size_t>& next, NarrowResult& result) {
    NarrowMember& one = member(device);
    std::pair<std::size_t, std::size_t> rows;
    one.worker().timed([&] { rows = one.put_chunk(call, next, result); });
    return rows;
}

bool NarrowDevices::finish_stream(NarrowReport& report) {
    for (std::size_t i = 0; i < members_.size(); ++i)
        if (members_[i] && members_[i]->worker().share().chunks > 0) add_to(report, i, 0);
    return any_margins();
}

void NarrowDevices::find_on_one(const NarrowCall& call, std::size_t device, NarrowResult& result) {
    NarrowMember& only = member(device);
    only.worker().timed([&] {
        for (std::size_t first = 0; first < call.pairs.size(); first += chunk_pairs)
            only.append_chunk(call, first, std::min(chunk_pairs, call.pairs.size() - first), result);
    });
}

bool NarrowDevices::find_on_several(const NarrowCall& call, const std::vector<std::size_t>& crew, NarrowResult& result,
                                    std::vector<Failure>& failures, NarrowReport& report) {
    std::vector<std::size_t> opened;
    std::vector<NarrowMember*> members;
    for (const std::size_t device : crew) try {
            members.push_back(&member(device));
            opened.push_back(device);
        } catch (...) {
            if (!is_device_fault(std::current_exception())) throw;
            failures.push_back({device, std::current_exception()});
        }
    const std::size_t chunks = (call.pairs.size() + chunk_pairs - 1) / chunk_pairs;
    NarrowSplit split(call, chunk_pairs, members, takers_for(opened, chunks), result);
    const bool done = split.run();
    for (std::size_t k = 0; k < opened.size(); ++k) {
        if (split.fault(k) != nullptr) failures.push_back({opened[k], split.fault(k)});
        if (done && members[k]->worker().share().chunks > 0) add_to(report, opened[k], split.stolen(k));
    }
    return done;
}

void NarrowDevices::add_to(NarrowReport& report, std::size_t device, std::uint64_t stolen) {
    const NarrowShare& share = members_[device]->worker().share();
    share.add_to(report);
    report.devices.push_back({device, share.pairs, share.chunks, stolen, share.ms.total});
}

void NarrowDevices::learn(std::size_t chunks) {
    std::vector<Shares::Measure> measures;
    for (const std::size_t device : sharing_) {
        if (!members_[device]) {
            measures.push_back({0.0, 0.0});
            continue;
        }
        const NarrowShare& share = members_[device]->worker().share();
        measures.push_back({static_cast<double>(share.pairs), (share.ms.total - share.build_ms) / 1000.0});
    }
    shares_->measured(measures);
    measured_chunks_ = chunks;
}

void NarrowDevices::retire(const std::vector<Failure>& failures, bool done, NarrowReport& report) {
    for (const Failure& failure : failures) {
        if (!context_.retire(failure.device, message_of(failure.why))) {
            if (!done) std::rethrow_exception(failure.why);
            continue;
        }
        members_[failure.device].reset();
        report.warnings.push_back(context_.why_retired(failure.device));
    }
}

}  // namespace clinch::detail
