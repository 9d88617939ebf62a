#include "src/narrow_phase/narrow_split.hpp"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include "src/device/crew.hpp"
#include "src/primitives/host_parallel.hpp"

namespace clinch::detail {
namespace {

std::uint32_t chunks_of(std::size_t pairs, std::size_t chunk_pairs) {
    return static_cast<std::uint32_t>((pairs + chunk_pairs - 1) / chunk_pairs);
}

}  // namespace

bool same_answers(const DeviceInfo& a, const DeviceInfo& b) {
    const auto kind = [](const DeviceInfo& d) {
        return std::tie(d.platform, d.platform_version, d.driver_version, d.name, d.version, d.lanes, d.fp64,
                        d.exact_division, d.unified_memory);
    };
    return kind(a) == kind(b);
}

NarrowSplit::NarrowSplit(const NarrowCall& call, std::size_t chunk_pairs, std::vector<NarrowMember*> members,
                         const std::vector<ChunkQueue::Taker>& takers, NarrowResult& result)
    : call_(call),
      chunk_pairs_(chunk_pairs),
      members_(std::move(members)),
      result_(result),
      queue_(chunks_of(call.pairs.size(), chunk_pairs), takers),
      places_(chunks_of(call.pairs.size(), chunk_pairs)),
      faults_(members_.size()),
      wrong_chunk_(std::numeric_limits<std::uint32_t>::max()) {}

bool NarrowSplit::is_needed(std::uint32_t chunk) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return chunk < wrong_chunk_;
}

bool NarrowSplit::run() {
    std::vector<std::size_t> crew(members_.size());
    for (std::size_t k = 0; k < crew.size(); ++k) crew[k] = k;
    // More than once if some had no more to do when a chunk came back.
    while (!crew.empty() && queue_.left() > 0) {
        std::vector<char> began(crew.size(), 0);
        const std::vector<std::exception_ptr> thrown = run_crew(crew.size(), [&](std::size_t i) {
            began[i] = 1;
            work(crew[i]);
        });
        std::vector<std::size_t> remaining;
        for (std::size_t i = 0; i < crew.size(); ++i) {
            if (thrown[i] == nullptr) {
                remaining.push_back(crew[i]);
                continue;
            }
            if (began[i] == 0) {  // no thread for it: not its fault, but it takes no part
                queue_.retire(crew[i], std::nullopt);
                continue;
            }
            if (!is_device_fault(thrown[i])) std::rethrow_exception(thrown[i]);
            faults_[crew[i]] = thrown[i];
        }
        crew = std::move(remaining);
    }
    if (wrong_) std::rethrow_exception(wrong_);
    if (queue_.left() > 0) return false;
    finish();
    return true;
}

void NarrowSplit::work(std::size_t k) {
    std::optional<std::uint32_t> chunk;
    try {
        members_[k]->worker().timed([&] {
            while ((chunk = queue_.take(k)))
                if (is_needed(*chunk)) do_chunk(k, *chunk);
        });
    } catch (...) {
        // What it had finished before is on the host's side.
        members_[k]->settle(call_, places_, result_);
        give_back(k, chunk);
        throw;
    }
    members_[k]->settle(call_, places_, result_);
}

// Throws only what is the device's fault; else says which chunk is wrong.
void NarrowSplit::do_chunk(std::size_t k, std::uint32_t chunk) {
    const std::size_t first = chunk * chunk_pairs_;
    try {
        members_[k]->do_chunk(call_, chunk, first, std::min(chunk_pairs_, call_.pairs.size() - first), places_,
                              result_);
    } catch (...) {
        const std::exception_ptr thrown = std::current_exception();
        if (is_device_fault(thrown)) throw;
        const std::lock_guard<std::mutex> lock(mutex_);
        if (chunk >= wrong_chunk_) return;
        wrong_chunk_ = chunk;
        wrong_ = thrown;
    }
}

// Others find the chunk as it was.
void NarrowSplit::give_back(std::size_t k, std::optional<std::uint32_t> chunk) {
    if (chunk && call_.warm != nullptr) {
        const std::size_t first = *chunk * chunk_pairs_;
        call_.warm->restore(first, std::min(chunk_pairs_, call_.pairs.size() - first));
    }
    queue_.retire(k, chunk);
}

void NarrowSplit::finish() {
    result_.resize(call_.only_pairs, places_.told());
    parallel_for(members_.size(), members_.size() > 1,
                 [&](std::size_t k) { members_[k]->copy_set_aside(call_, places_, result_); });
}

}  // namespace clinch::detail
