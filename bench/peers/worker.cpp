#include "bench/peers/worker.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <stdexcept>

namespace clinch::peers {
namespace {

using Clock = std::chrono::steady_clock;

std::uint64_t count(const Lists& lists) {
    std::uint64_t pairs = 0;
    for (const View<const Pair>& list : lists) pairs += list.size();
    return pairs;
}

/// The finaliser of splitmix64 over both numbers, summed.
std::uint64_t mark_of(const Lists& lists) {
    std::uint64_t sum = 0;
    for (const View<const Pair>& list : lists)
        for (const Pair& pair : list) {
            std::uint64_t x = std::uint64_t{std::min(pair.a, pair.b)} << 32 | std::max(pair.a, pair.b);
            x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
            x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
            sum += x ^ (x >> 31);
        }
    return sum;
}

/// The child's side of a worker.
class Runner {
public:
    Runner(const PeerRow& row, const Scenes& scenes, const Setup& setup) : peer_(row.make(setup)), scenes_(scenes) {}

    Answer first() {
        Answer answer;
        for (const std::size_t scene : {1u, 0u}) {
            answer.ms[0] = timed(scene);
            pairs_[scene] = count(lists_);
            answer.mark = 3 * answer.mark + mark_of(lists_);
        }
        answer.runs = 1;
        answer.pairs = pairs_[0];
        return done(answer);
    }

    Answer warm_up(std::uint64_t pairs) {
        Answer answer;
        answer.ms[0] = timed(1);
        answer.runs = 1;
        pairs_ = {pairs, count(lists_)};
        next_ = 1;
        return done(answer);
    }

    Answer more(double enough_ms) {
        Answer answer;
        double sum = 0.0;
        do {
            next_ = 1 - next_;
            answer.ms[answer.runs] = timed(next_);
            sum += answer.ms[answer.runs++];
            if (count(lists_) != pairs_[next_])
                throw std::runtime_error("found " + std::to_string(pairs_[next_]) + " pairs at first, now " +
                                         std::to_string(count(lists_)));
        } while (sum < enough_ms && answer.runs < Answer::most_runs);
        if (answer.runs > 1) {
            std::copy(answer.ms.begin() + 1, answer.ms.begin() + answer.runs, answer.ms.begin());
            --answer.runs;
        }
        return done(answer);
    }

private:
    double timed(std::size_t scene) {
        lists_.clear();
        const Clock::time_point start = Clock::now();
        lists_ = peer_->run(scenes_[scene]);
        return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    }
    Answer done(Answer answer) const {
        set_text(answer.chosen, peer_->chosen());
        answer.peak_bytes = peak_bytes();
        answer.done = true;
        return answer;
    }

    std::unique_ptr<Peer> peer_;
    const Scenes& scenes_;
    Lists lists_;
    std::array<std::uint64_t, 2> pairs_{};
    std::size_t next_ = 0;
};

}  // namespace

void Worker::serve(const PeerRow& row, const Scenes& scenes, const Setup& setup, int commands, int answers) {
    std::unique_ptr<Runner> runner;
    answer_all<Command, Answer>(commands, answers, [&](const Command& command) {
        if (!runner) runner = std::make_unique<Runner>(row, scenes, setup);
        return command.job == 'f'   ? runner->first()
               : command.job == 'w' ? runner->warm_up(command.pairs)
                                    : runner->more(command.enough_ms);
    });
}

Worker::Worker(const PeerRow& row, const Scenes& scenes, const Setup& setup)
    : process_([&](int commands, int answers) { serve(row, scenes, setup, commands, answers); }) {}

}  // namespace clinch::peers
