#include "bench/machines/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <utility>

#include "src/schedule/chunk_queue.hpp"

namespace clinch::machines {

namespace {

using detail::ChunkQueue;
using MaybeChunk = std::optional<std::uint32_t>;

enum class Kind { Sent, Computed, Arrived, Failed };

struct Event {
    double time;
    std::uint64_t order;  // events of the same time: as they were made
    Kind kind;
    std::size_t device;
    std::uint32_t chunk;

    bool operator>(const Event& other) const { return time != other.time ? time > other.time : order > other.order; }
};

// What a device is at: a chunk on its way there, one that waits to be computed, one being computed, results on the way.
struct State {
    MaybeChunk sent, waiting, computed;
    std::vector<std::uint32_t> results;
    double up_free = 0.0, down_free = 0.0, last = 0.0, pace = 1.0;
    bool begun = false, idle = false, failed = false;
};

// One step, event by event. Times are seconds since its begin.
class Run {
public:
    Run(const Machine& machine, const Load& load, ChunkQueue& queue, VirtualClock& clock)
        : machine_(machine),
          load_(load),
          queue_(queue),
          clock_(clock),
          begin_(clock.now()),
          states_(machine.devices.size()),
          arrived_(load.chunks.size(), false) {}

    void set_pace(std::size_t device, double pace) { states_[device].pace = pace; }
    void run();
    double last(std::size_t device) const { return states_[device].last; }
    bool failed(std::size_t device) const { return states_[device].failed; }
    double end() const { return std::max(end_, host_free_); }

private:
    void at(double time, Kind kind, std::size_t device, std::uint32_t chunk) {
        events_.push({time, order_++, kind, device, chunk});
    }
    double over_memory(double time, double bytes);
    void fetch(std::size_t device);
    void compute(std::size_t device);
    void send_back(std::size_t device, std::uint32_t chunk);
    void arrive(std::size_t device, std::uint32_t chunk);
    void fail(std::size_t device);
    void handle(const Event& event);

    const Machine& machine_;
    const Load& load_;
    ChunkQueue& queue_;
    VirtualClock& clock_;
    double begin_, now_ = 0.0, memory_free_ = 0.0, host_free_ = 0.0, end_ = 0.0;
    std::uint64_t order_ = 0;
    std::size_t placed_ = 0;
    std::vector<State> states_;
    std::vector<bool> arrived_;
    std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
};

// When the host's memory is through with so many bytes, first come first served.
double Run::over_memory(double time, double bytes) {
    memory_free_ = std::max(memory_free_, time) + bytes / machine_.host.memory_bandwidth;
    return memory_free_;
}

// Asks for a chunk as soon as there is room for one besides the one being computed, and sends it.
void Run::fetch(std::size_t device) {
    State& state = states_[device];
    if (state.failed || state.sent || state.waiting) return;
    state.sent = queue_.take(device);
    state.idle = !state.sent;
    if (state.idle) return;
    const Device& own = machine_.devices[device];
    const double begin = state.begun ? now_ : now_ + own.begin_seconds;
    const double bytes = load_.chunks[*state.sent].bytes_up + (state.begun ? 0.0 : load_.bytes_to_begin);
    state.begun = true;
    state.up_free = std::max(std::max(begin, state.up_free) + bytes / own.bandwidth, over_memory(begin, bytes));
    at(state.up_free, Kind::Sent, device, *state.sent);
}

void Run::compute(std::size_t device) {
    State& state = states_[device];
    if (state.computed || !state.waiting) return;
    state.computed = std::exchange(state.waiting, std::nullopt);
    const Device& own = machine_.devices[device];
    const double work = load_.chunks[*state.computed].seconds / own.speed * state.pace;
    at(now_ + own.launch_seconds + work, Kind::Computed, device, *state.computed);
    fetch(device);
}

void Run::send_back(std::size_t device, std::uint32_t chunk) {
    State& state = states_[device];
    const double bytes = load_.chunks[chunk].bytes_down;
    state.results.push_back(chunk);
    state.down_free = std::max(std::max(now_, state.down_free) + bytes / machine_.devices[device].bandwidth,
                               over_memory(now_, bytes));
    at(state.down_free, Kind::Arrived, device, chunk);
}

// Results are put behind those of all chunks before: read, merged, written.
void Run::arrive(std::size_t device, std::uint32_t chunk) {
    State& state = states_[device];
    state.results.erase(std::find(state.results.begin(), state.results.end(), chunk));
    state.last = end_ = now_;
    arrived_[chunk] = true;
    for (; placed_ < arrived_.size() && arrived_[placed_]; ++placed_) {
        const double bytes = load_.chunks[placed_].bytes_down;
        const double copied = over_memory(now_, 2.0 * bytes);
        host_free_ = std::max(copied, std::max(host_free_, now_) + bytes * machine_.host.merge_seconds_a_byte);
    }
}

// All it has in hand is lost; whoever had nothing to do asks again.
void Run::fail(std::size_t device) {
    State& state = states_[device];
    state.failed = true;
    queue_.retire(device, std::nullopt);
    for (const MaybeChunk& held : {state.sent, state.waiting, state.computed})
        if (held) queue_.retire(device, held);
    for (const std::uint32_t held : state.results) queue_.retire(device, held);
    for (std::size_t i = 0; i < states_.size(); ++i)
        if (states_[i].idle) fetch(i);
}

void Run::handle(const Event& event) {
    State& state = states_[event.device];
    if (state.failed) return;
    switch (event.kind) {
        case Kind::Sent:
            state.waiting = std::exchange(state.sent, std::nullopt);
            return compute(event.device);
        case Kind::Computed:
            state.computed.reset();
            send_back(event.device, event.chunk);
            return compute(event.device);
        case Kind::Arrived:
            return arrive(event.device, event.chunk);
        case Kind::Failed:
            return fail(event.device);
    }
}

void Run::run() {
    for (std::size_t i = 0; i < states_.size(); ++i)
        if (std::isfinite(machine_.devices[i].fails_at))
            at(std::max(0.0, machine_.devices[i].fails_at - begin_), Kind::Failed, i, 0);
    for (std::size_t i = 0; i < states_.size(); ++i) fetch(i);
    while (!events_.empty() && placed_ < arrived_.size()) {
        const Event event = events_.top();
        events_.pop();
        now_ = event.time;
        clock_.set(begin_ + now_);
        handle(event);
    }
}

std::vector<double> ones(std::size_t count) {
    return std::vector<double>(count, 1.0);
}

}  // namespace

Simulation::Simulation(Machine machine, std::uint64_t seed)
    : machine_(std::move(machine)), shares_(ones(machine_.devices.size())), random_(seed) {}

Step Simulation::step(const Load& load) {
    const std::size_t count = machine_.devices.size();
    const auto chunks = static_cast<std::uint32_t>(load.chunks.size());
    std::vector<ChunkQueue::Taker> takers;
    for (std::size_t i = 0; i < count; ++i) {
        const detail::Shares::Estimate known = shares_.estimate(i);
        takers.push_back(
            {shares_.fractions()[i], known.seconds_for_all / std::max(chunks, 1u), known.seconds_to_begin});
    }
    ChunkQueue queue(chunks, takers);
    const double begin = clock_.now();
    Run run(machine_, load, queue, clock_);
    for (std::size_t i = 0; i < count; ++i) run.set_pace(i, random_.between(1.0, 1.0 + machine_.noise));
    run.run();
    clock_.set(begin + run.end());

    Step step;
    std::vector<detail::Shares::Measure> measures;
    for (std::size_t i = 0; i < count; ++i) {
        step.devices.push_back({queue.taken(i), queue.stolen(i), run.last(i)});
        step.stolen += static_cast<double>(queue.stolen(i)) / chunks;
        measures.push_back({static_cast<double>(queue.taken(i)), run.last(i)});
    }
    shares_.measured(measures);
    for (std::size_t i = 0; i < count; ++i)
        if (run.failed(i)) shares_.retire(i);
    step.seconds = clock_.now() - begin;
    step.left = queue.left();
    return step;
}

Step settled(const Machine& machine, const Load& load, int steps, std::uint64_t seed) {
    Simulation simulation(machine, seed);
    Step last;
    for (int i = 0; i < steps; ++i) last = simulation.step(load);
    return last;
}

}  // namespace clinch::machines
