// One narrow-phase call on several devices: chunks are dealt by share, an idle device takes over half of what the
// busiest has left, and the result is byte for byte that of one device [thesis 5.3.2].
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <mutex>
#include <optional>
#include <vector>

#include "clinch/device.hpp"
#include "src/narrow_phase/contact_places.hpp"
#include "src/narrow_phase/narrow_call.hpp"
#include "src/narrow_phase/narrow_member.hpp"
#include "src/schedule/chunk_queue.hpp"

namespace clinch::detail {

/// Whether two devices give the same bytes for the same chunk, so that they may share a call: the same hardware under
/// the same driver, but for how many cores it has. Elsewhere, where one has no float64 or cannot run long loops, other
/// code decides, and float32 quotients, roots and products are rounded in other ways: PoCL and rusticl differ in every
/// fifth contact at low precision and in all at high. PoCL's bytes are the same for 1, 8 and 16 lanes, which is not
/// relied on.
bool same_answers(const DeviceInfo& a, const DeviceInfo& b);

/// Lives for one call. Chunks are cut at the same places whatever the devices are.
class NarrowSplit {
public:
    /// One taker a member, in their order; start_call() was called of each. All must outlive this object.
    NarrowSplit(const NarrowCall& call, std::size_t chunk_pairs, std::vector<NarrowMember*> members,
                const std::vector<ChunkQueue::Taker>& takers, NarrowResult& result);

    /// Does all chunks; one host thread a member. What a member that fails has left is done by the others. True: the
    /// result is whole. False: no member is left. Throws what is not a device's fault, that of the first chunk if
    /// several are wrong.
    bool run();
    /// Why a member failed; null where it did not.
    const std::exception_ptr& fault(std::size_t k) const { return faults_[k]; }
    /// Chunks it took over from others.
    std::uint32_t stolen(std::size_t k) const { return queue_.stolen(k); }

private:
    bool is_needed(std::uint32_t chunk) const;
    void work(std::size_t k);
    void do_chunk(std::size_t k, std::uint32_t chunk);
    void give_back(std::size_t k, std::optional<std::uint32_t> chunk);
    void finish();

    NarrowCall call_;
    std::size_t chunk_pairs_;
    std::vector<NarrowMember*> members_;
    NarrowResult& result_;
    ChunkQueue queue_;
    ContactPlaces places_;
    std::vector<std::exception_ptr> faults_;
    mutable std::mutex mutex_;
    std::uint32_t wrong_chunk_;  // chunks behind it are not needed any more
    std::exception_ptr wrong_;   // what it threw
};

}  // namespace clinch::detail
