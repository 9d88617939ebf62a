// One chunk of pairs on one device: from grouping to contacts that are ready to be written.
#pragma once

#include <cstddef>
#include <memory>

#include "src/narrow_phase/chunk_contacts.hpp"
#include "src/narrow_phase/manifolds.hpp"
#include "src/narrow_phase/narrow_worker.hpp"
#include "src/narrow_phase/slots.hpp"

namespace clinch::detail {

/// Does chunks to the end, one after the other, in memory that it keeps. In the thread of its worker.
class ChunkWork {
public:
    /// `worker` must outlive this object. Allocates nothing yet.
    explicit ChunkWork(NarrowWorker& worker) : worker_(worker), slots_(worker.device()) {}

    /// Finds what `count` pairs of the call from number `first` on have, and counts it; writes their corners if the
    /// call is warm. Waits. Throws Error; then contacts() is empty.
    void solve(const NarrowCall& call, std::size_t first, std::size_t count);
    /// What the chunk has, until the next one; to be released when it has been written.
    ChunkContacts& contacts() noexcept { return contacts_; }

private:
    void group(const NarrowCall& call);
    void find_answers(const NarrowCall& call, std::size_t first);
    bool any_starts_warm(const NarrowCall& call) const;
    void do_bucket(const NarrowCall& call, std::size_t k);
    void decide(const NarrowCall& call);
    void run(const NarrowCall& call, std::size_t k, const BucketSlice& slice, unsigned bits);
    void run_float64(const NarrowCall& call, std::size_t k, const BucketSlice& slice);
    void run_on_host(const NarrowCall& call, std::size_t k, const BucketSlice& slice);
    bool may_have_points() const;
    void take_gathered(const NarrowCall& call);
    ChunkContacts::Points find_points(const NarrowCall& call, const GatheredContacts& gathered);

    NarrowWorker& worker_;
    Slots slots_;
    std::unique_ptr<Manifolds> manifolds_;
    Buffer corners_;  // of the chunk's pairs
    View<const Pair> pairs_;
    ChunkContacts contacts_;
};

}  // namespace clinch::detail
