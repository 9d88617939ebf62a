#include "src/schedule/chunk_queue.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>
#include <string>
#include <utility>

#include "clinch/error.hpp"

namespace clinch::detail {

namespace {

constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();

void check(double value, const char* name) {
    if (std::isfinite(value) && value >= 0.0) return;
    throw Error(ErrorCode::InvalidArgument, std::string(name) + " of a taker of chunks is " + std::to_string(value) +
                                                ": must be finite and not negative");
}

// Whole amounts in proportion to the weights that sum to n, by largest remainder; ties to the first.
std::vector<std::size_t> amounts(const std::vector<double>& weights, std::size_t n) {
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    std::vector<std::size_t> amount(weights.size());
    std::vector<std::pair<double, std::size_t>> remainders;
    std::size_t dealt = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const double exact = static_cast<double>(n) * (weights[i] / sum);
        amount[i] = std::min(n - dealt, static_cast<std::size_t>(exact));
        dealt += amount[i];
        if (weights[i] > 0.0) remainders.emplace_back(static_cast<double>(amount[i]) - exact, i);
    }
    std::sort(remainders.begin(), remainders.end());
    for (std::size_t k = 0; dealt < n; ++k, ++dealt) ++amount[remainders[k % remainders.size()].second];
    return amount;
}

}  // namespace

ChunkQueue::ChunkQueue(std::uint32_t chunks, const std::vector<Taker>& takers) {
    for (const Taker& taker : takers) {
        check(taker.fraction, "the fraction");
        check(taker.seconds_a_chunk, "seconds_a_chunk");
        check(taker.seconds_to_begin, "seconds_to_begin");
        State state{};
        state.cost = taker;
        takers_.push_back(std::move(state));
    }
    guess_paces();
    chunks_.assign(chunks, {nobody, nobody});
    left_ = chunks;
    if (takers_.empty()) return;
    std::vector<std::uint32_t> all(chunks);
    std::iota(all.begin(), all.end(), 0u);
    std::vector<std::size_t> everyone(takers_.size());
    std::iota(everyone.begin(), everyone.end(), std::size_t{0});
    deal(all, everyone);
}

// Adds ascending `chunks` to what `to` have: each in proportion to its fraction, in the order of finishing.
void ChunkQueue::deal(const std::vector<std::uint32_t>& chunks, const std::vector<std::size_t>& to) {
    std::vector<double> weights;
    weights.reserve(to.size());
    for (const std::size_t taker : to) weights.push_back(takers_[taker].cost.fraction);
    if (std::none_of(weights.begin(), weights.end(), [](double weight) { return weight > 0.0; }))
        weights.assign(weights.size(), 1.0);
    const std::vector<std::size_t> amount = amounts(weights, chunks.size());
    std::vector<std::size_t> dealt(to.size(), 0), before;
    before.reserve(to.size());
    for (const std::size_t taker : to) before.push_back(takers_[taker].own.size());

    using Next = std::pair<double, std::size_t>;  // when the taker's next chunk would be finished
    std::priority_queue<Next, std::vector<Next>, std::greater<>> order;
    for (std::size_t k = 0; k < to.size(); ++k)
        if (amount[k] > 0) order.emplace(1.0 / weights[k], k);
    for (const std::uint32_t chunk : chunks) {
        const std::size_t k = order.top().second;
        order.pop();
        takers_[to[k]].own.push_back(chunk);
        chunks_[chunk].dealt_to = static_cast<std::uint32_t>(to[k]);
        if (++dealt[k] < amount[k]) order.emplace(static_cast<double>(dealt[k] + 1) / weights[k], k);
    }
    for (std::size_t k = 0; k < to.size(); ++k) {
        std::deque<std::uint32_t>& own = takers_[to[k]].own;
        std::inplace_merge(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(before[k]), own.end());
    }
}

// An unmeasured taker is held to be as fast as its fraction says beside the measured ones; one without a fraction, as
// the average.
void ChunkQueue::guess_paces() {
    double work = 0.0, fractions = 0.0, sum = 0.0;
    std::size_t measured = 0, with_fraction = 0;
    for (const State& state : takers_) {
        sum += state.cost.fraction;
        if (state.cost.fraction > 0.0) ++with_fraction;
        if (state.cost.seconds_a_chunk <= 0.0 || state.cost.fraction <= 0.0) continue;
        work += state.cost.seconds_a_chunk * state.cost.fraction;
        fractions += state.cost.fraction;
        ++measured;
    }
    const double scale = measured > 0 ? work / static_cast<double>(measured) : 1.0;
    const double average = with_fraction > 0 ? sum / static_cast<double>(with_fraction) : 1.0;
    for (State& state : takers_) {
        const double fraction = state.cost.fraction > 0.0 ? state.cost.fraction : average;
        state.pace = state.cost.seconds_a_chunk > 0.0 ? state.cost.seconds_a_chunk : scale / fraction;
    }
}

std::optional<std::uint32_t> ChunkQueue::take(std::size_t taker) {
    const std::lock_guard<std::mutex> lock(mutex_);
    State& self = takers_.at(taker);
    self.resting = false;
    if (self.retired || (self.own.empty() && !steal(self))) {
        self.resting = true;
        return std::nullopt;
    }
    const std::uint32_t chunk = self.own.front();
    self.own.pop_front();
    --left_;
    ++self.taken;
    chunks_[chunk].held_by = static_cast<std::uint32_t>(taker);
    if (chunks_[chunk].dealt_to != taker) ++self.stolen;
    return chunk;
}

// What it takes the victim to do by itself all it has; how much of the chunk in its hands is done is not known: half.
double ChunkQueue::seconds_left(const State& victim) const {
    if (victim.resting || victim.retired) return std::numeric_limits<double>::infinity();
    const double begin = victim.taken > 0 ? 0.5 * victim.pace : victim.cost.seconds_to_begin;
    return begin + static_cast<double>(victim.own.size()) * victim.pace;
}

// How many chunks the thief gains by taking from the victim; 0: it would be done later than the victim alone.
std::size_t ChunkQueue::pays(const State& thief, const State& victim) const {
    std::size_t amount = (victim.own.size() + 1) / 2;
    if (victim.cost.seconds_a_chunk <= 0.0) return amount;
    const double alone = seconds_left(victim), begin = thief.taken > 0 ? 0.0 : thief.cost.seconds_to_begin;
    while (amount > 0 && begin + static_cast<double>(amount) * thief.cost.seconds_a_chunk > alone) amount /= 2;
    return amount;
}

bool ChunkQueue::steal(State& thief) {
    State* victim = nullptr;
    for (State& other : takers_)
        if (!other.own.empty() && (victim == nullptr || seconds_left(other) > seconds_left(*victim))) victim = &other;
    if (victim == nullptr) return false;
    const std::size_t amount = pays(thief, *victim);
    const auto from = victim->own.end() - static_cast<std::ptrdiff_t>(amount);
    thief.own.assign(from, victim->own.end());
    victim->own.erase(from, victim->own.end());
    return amount > 0;
}

// Who gets the chunks of one that fails: those at work, else those that may be asked again, else anyone.
std::vector<std::size_t> ChunkQueue::heirs() const {
    std::vector<std::size_t> working, waiting, anyone;
    for (std::size_t i = 0; i < takers_.size(); ++i) {
        const State& state = takers_[i];
        if (state.retired) continue;
        anyone.push_back(i);
        if (state.cost.fraction > 0.0 || state.taken > 0) (state.resting ? waiting : working).push_back(i);
    }
    return !working.empty() ? working : !waiting.empty() ? waiting : anyone;
}

void ChunkQueue::retire(std::size_t taker, std::optional<std::uint32_t> in_hand) {
    const std::lock_guard<std::mutex> lock(mutex_);
    State& self = takers_.at(taker);
    if (in_hand && (*in_hand >= chunks_.size() || chunks_[*in_hand].held_by != taker))
        throw Error(ErrorCode::InvalidArgument, "chunk " + std::to_string(*in_hand) + " is not in the hands of taker " +
                                                    std::to_string(taker) + ", which gives it back");
    self.retired = true;
    if (in_hand) {
        Chunk& chunk = chunks_[*in_hand];
        --self.taken;
        if (chunk.dealt_to != taker) --self.stolen;
        chunk.held_by = nobody;
        self.own.insert(std::lower_bound(self.own.begin(), self.own.end(), *in_hand), *in_hand);
        ++left_;
    }
    const std::vector<std::size_t> to = heirs();
    if (to.empty()) return;
    const std::vector<std::uint32_t> chunks(self.own.begin(), self.own.end());
    self.own.clear();
    deal(chunks, to);
}

std::uint32_t ChunkQueue::taken(std::size_t taker) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return takers_.at(taker).taken;
}

std::uint32_t ChunkQueue::stolen(std::size_t taker) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return takers_.at(taker).stolen;
}

std::uint32_t ChunkQueue::left() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return left_;
}

}  // namespace clinch::detail
