#include "bench/peers/narrow/worker.hpp"

#include <omp.h>
#include <sched.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <stdexcept>
#include <thread>

namespace clinch::peers::narrow {
namespace {

using Clock = std::chrono::steady_clock;

/// Threads of loops, of oneTBB and of OpenMP.
int threads_of(bool one) {
    return one ? 1 : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

/// Before the first word to OpenCL. PoCL makes a thread for every core of the machine unless told otherwise.
void use_cores(bool one, unsigned core) {
    omp_set_num_threads(threads_of(one));
    if (!one) return;
    setenv("POCL_MAX_PTHREAD_COUNT", "1", 1);
#ifdef __linux__
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(core, &set);
    if (sched_setaffinity(0, sizeof set, &set) != 0)
        throw std::runtime_error("core " + std::to_string(core) + " cannot be had");
#else
    (void)core;
#endif
}

/// Of all threads of the process so far.
double cpu_ms() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// The child's side of a worker.
class Runner {
public:
    Runner(const PeerRow& row, const Batch& batch, Question question, unsigned core)
        : batch_(batch), question_(question) {
        use_cores(row.one_core, core);
        peer_ = row.make(batch, question);
        if (!peer_) throw std::runtime_error("has no answer to this");
    }

    Turn first() {
        Turn turn;
        timed(turn);
        turn.runs = 1;
        turn.verdict = judge(batch_, question_, peer_->answers());
        peer_->routines_ms();
        return done(turn);
    }

    Turn more(double enough_ms) {
        Turn turn;
        double sum = 0.0;
        do {
            timed(turn);
            turn.routines_ms[turn.runs] = peer_->routines_ms();
            sum += turn.ms[turn.runs++];
        } while (sum < enough_ms && turn.runs < Turn::most_runs);
        if (turn.runs > 1) {
            const auto forget_first = [&](auto& list) {
                std::copy(list.begin() + 1, list.begin() + turn.runs, list.begin());
            };
            forget_first(turn.ms);
            forget_first(turn.cpu_ms);
            forget_first(turn.routines_ms);
            --turn.runs;
        }
        return done(turn);
    }

private:
    void timed(Turn& turn) {
        const double cpu_start = cpu_ms();
        const Clock::time_point start = Clock::now();
        peer_->run();
        turn.ms[turn.runs] = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
        turn.cpu_ms[turn.runs] = cpu_ms() - cpu_start;
    }
    static Turn done(Turn turn) {
        turn.peak_bytes = peak_bytes();
        turn.done = true;
        return turn;
    }

    const Batch& batch_;
    Question question_;
    std::unique_ptr<Peer> peer_;
};

}  // namespace

Worker::Worker(const PeerRow& row, const Batch& batch, Question question, unsigned core)
    : process_([&](int commands, int answers) {
          tbb::task_arena(threads_of(row.one_core)).execute([&] {
              std::unique_ptr<Runner> runner;
              answer_all<Command, Turn>(commands, answers, [&](const Command& command) {
                  if (!runner) runner = std::make_unique<Runner>(row, batch, question, core);
                  return command.job == 'f' ? runner->first() : runner->more(command.enough_ms);
              });
          });
      }) {}

}  // namespace clinch::peers::narrow
