#include "src/pipeline/phase_run.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "src/device/crew.hpp"
#include "src/device/stopwatch.hpp"

namespace clinch::detail {

PhaseRun::PhaseRun(NarrowStream& narrow, const PhaseRoles& roles, std::size_t chunk_pairs, bool help, Memory& memory)
    : narrow_(narrow),
      roles_(roles),
      chunk_pairs_(chunk_pairs),
      most_waiting_(2 * roles.narrow.size() + 2),
      help_(help || (roles.narrow.empty() && !roles.alike.empty())),
      buffer_(most_waiting_, 1),
      memory_(memory) {
    for (const std::size_t device : roles_.broad) hands_[device];
    for (const std::size_t device : roles_.narrow) hands_[device];
    hands_[host];
}

bool PhaseRun::helps(std::size_t device) const {
    return help_ && std::find(roles_.alike.begin(), roles_.alike.end(), device) != roles_.alike.end();
}

PhaseRun::Chunk PhaseRun::fresh() {
    Chunk chunk;
    {
        const std::lock_guard<std::mutex> lock(memory_.mutex);
        if (!memory_.spare.empty()) {
            chunk = std::move(memory_.spare.back());
            memory_.spare.pop_back();
        }
    }
    chunk.clear();
    chunk.reserve(chunk_pairs_);
    return chunk;
}

void PhaseRun::take(std::size_t device, View<const Pair> pairs) {
    Hands& hands = hands_.at(device);
    hands.pairs += pairs.size();
    for (std::size_t first = 0; first < pairs.size();) {
        if (hands.chunk.capacity() == 0) hands.chunk = fresh();
        const std::size_t count = std::min(chunk_pairs_ - hands.chunk.size(), pairs.size() - first);
        hands.chunk.insert(hands.chunk.end(), pairs.data() + first, pairs.data() + first + count);
        first += count;
        if (hands.chunk.size() == chunk_pairs_) deliver(device, hands.chunk);
    }
}

void PhaseRun::pause(std::size_t device) {
    Hands& hands = hands_.at(device);
    if (!roles_.narrow.empty() && hands.chunk.size() >= NarrowStream::few_pairs) deliver(device, hands.chunk);
}

// Into the buffer; while that is full, a device that may does one itself instead of waiting.
void PhaseRun::deliver(std::size_t device, Chunk& chunk) {
    ++chunks_;
    Chunk full = std::exchange(chunk, Chunk());
    if (!helps(device)) {
        if (!buffer_.put(std::move(full))) throw Stopped{};
        return;
    }
    while (!buffer_.try_put(full))
        if (std::optional<Chunk> other = buffer_.try_take()) do_chunk(device, std::move(*other));
    if (buffer_.cancelled()) throw Stopped{};
}

// The narrow phase at work on a device, which may fail.
template <class Work>
void PhaseRun::work_on(std::size_t device, const Work& work) {
    const Stopwatch watch;
    try {
        work();
    } catch (...) {
        if (device != host && is_device_fault(std::current_exception()))
            throw DeviceFault{device, std::current_exception()};
        throw;
    }
    hands_.at(device).narrow_ms += watch.ms();
}

void PhaseRun::do_chunk(std::size_t device, Chunk chunk) {
    const View<const Pair> pairs{chunk.data(), chunk.size()};
    work_on(device, [&] {
        if (device == host)
            narrow_.find_on_host(pairs);
        else
            narrow_.find(device, pairs);
    });
    const std::lock_guard<std::mutex> lock(memory_.mutex);
    memory_.spare.push_back(std::move(chunk));
}

void PhaseRun::do_all(std::size_t device, bool get_ready) {
    const ChunkBuffer<Chunk>::Consumer consumer(buffer_);
    if (get_ready) work_on(device, [&] { narrow_.prepare(device); });
    while (std::optional<Chunk> chunk = buffer_.take()) do_chunk(device, std::move(*chunk));
}

// What is left in chunks that are not full.
void PhaseRun::flush() {
    const std::size_t at = broad_place();
    Chunk rest = fresh();
    for (auto& [device, hands] : hands_) {
        for (const Pair& pair : hands.chunk) {
            rest.push_back(pair);
            if (rest.size() < chunk_pairs_) continue;
            deliver(at, rest);
            rest = fresh();
        }
        hands.chunk = Chunk();
    }
    if (rest.empty()) return;
    if (chunks_ == 0 && rest.size() < NarrowStream::few_pairs && !roles_.alike.empty())
        narrow_.find_on_host({rest.data(), rest.size()});
    else
        deliver(at, rest);
}

void PhaseRun::find_all(const FindPairs& find_pairs) {
    const Stopwatch watch;
    {
        const ChunkBuffer<Chunk>::Producer producer(buffer_);
        find_pairs(counts_);
        flush();
        broad_ms_ = watch.ms();
    }
    std::vector<std::size_t> free;
    for (const std::size_t device : roles_.broad)
        if (helps(device)) free.push_back(device);
    for (const std::exception_ptr& error : run_crew(free.size(), [&](std::size_t k) { do_all(free[k], false); }))
        if (error != nullptr) std::rethrow_exception(error);
}

std::vector<std::exception_ptr> PhaseRun::run(const FindPairs& find_pairs, bool expected) {
    const Stopwatch watch;
    std::vector<std::size_t> consumers = roles_.narrow;
    if (roles_.alike.empty()) consumers.push_back(host);
    std::vector<std::exception_ptr> thrown = run_crew(
        1 + consumers.size(),
        [&](std::size_t k) {
            if (k == 0) {
                find_all(find_pairs);
                return;
            }
            do_all(consumers[k - 1], expected && consumers[k - 1] != host);
        },
        [&](std::size_t) { buffer_.cancel(); });
    for (const auto& [device, hands] : hands_) pairs_ += hands.pairs;
    narrow_ms_ = watch.ms();
    return thrown;
}

double PhaseRun::narrow_work_ms() const {
    double ms = 0.0;
    for (const auto& [device, hands] : hands_) ms += hands.narrow_ms;
    return ms;
}

StreamWork PhaseRun::work() const {
    StreamWork work;
    work.broad_devices = static_cast<std::uint32_t>(roles_.broad.size());
    work.narrow_devices = static_cast<std::uint32_t>(roles_.narrow.size());
    work.chunks = chunks_;
    work.chunk_pairs = chunk_pairs_;
    work.most_waiting = buffer_.most_held();
    const std::size_t in_hands = roles_.broad.size() + roles_.narrow.size() + 2;
    work.pair_bytes = (most_waiting_ + in_hands) * chunk_pairs_ * sizeof(Pair);
    return work;
}

}  // namespace clinch::detail
