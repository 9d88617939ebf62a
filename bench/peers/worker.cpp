#include "bench/peers/worker.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <exception>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace clinch::peers {
namespace {

using Clock = std::chrono::steady_clock;

[[noreturn]] void fail(const char* what) {
    throw std::system_error(errno, std::generic_category(), what);
}

bool read_all(int from, void* to, std::size_t bytes) {
    for (auto* at = static_cast<char*>(to); bytes > 0;) {
        const ssize_t got = read(from, at, bytes);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        at += got;
        bytes -= static_cast<std::size_t>(got);
    }
    return true;
}

bool write_all(int to, const void* from, std::size_t bytes) {
    for (const auto* at = static_cast<const char*>(from); bytes > 0;) {
        const ssize_t put = write(to, at, bytes);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return false;
        at += put;
        bytes -= static_cast<std::size_t>(put);
    }
    return true;
}

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

std::uint64_t peak_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

template <std::size_t N>
void set_text(std::array<char, N>& to, const std::string& text) {
    to.fill('\0');
    std::copy_n(text.begin(), std::min(text.size(), N - 1), to.begin());
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

/// What libraries print would stand between our lines.
void silence() {
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere < 0) return;
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
}

}  // namespace

void Worker::serve(const PeerRow& row, const Scenes& scenes, const Setup& setup, int commands, int answers) {
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    silence();
    std::unique_ptr<Runner> runner;
    Command command{};
    while (read_all(commands, &command, sizeof command)) {
        Answer answer;
        try {
            if (!runner) runner = std::make_unique<Runner>(row, scenes, setup);
            answer = command.job == 'f'   ? runner->first()
                     : command.job == 'w' ? runner->warm_up(command.pairs)
                                          : runner->more(command.enough_ms);
        } catch (const std::exception& error) {
            set_text(answer.text, error.what());
        }
        if (!write_all(answers, &answer, sizeof answer)) break;
    }
    _exit(0);  // libraries' ends of program have nothing to say here
}

Worker::Worker(const PeerRow& row, const Scenes& scenes, const Setup& setup) {
    int commands[2] = {-1, -1}, answers[2] = {-1, -1};
    if (pipe2(commands, O_CLOEXEC) != 0) fail("pipe");
    if (pipe2(answers, O_CLOEXEC) != 0) {
        close(commands[0]);
        close(commands[1]);
        fail("pipe");
    }
    child_ = fork();
    if (child_ == 0) {
        close(commands[1]);
        close(answers[0]);
        serve(row, scenes, setup, commands[0], answers[1]);
    }
    close(commands[0]);
    close(answers[1]);
    commands_ = commands[1];
    answers_ = answers[0];
    if (child_ < 0) {
        close(commands_);
        close(answers_);
        fail("fork");
    }
}

// Other workers may hold copies of the pipes, so that closing them tells the child nothing.
Worker::~Worker() {
    if (child_ > 0) {
        kill(child_, SIGKILL);
        end_of_child();
    }
    close(commands_);
    close(answers_);
}

std::string Worker::end_of_child() {
    int status = 0;
    while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    child_ = -1;
    if (WIFSIGNALED(status)) return std::string("crashed: ") + strsignal(WTERMSIG(status));
    return "ended with status " + std::to_string(WEXITSTATUS(status));
}

Answer Worker::ask(const Command& command, double most_seconds) {
    Answer answer;
    if (child_ <= 0) {
        set_text(answer.text, "has ended");
        return answer;
    }
    pollfd ready{answers_, POLLIN, 0};
    int seen = 1;
    if (write_all(commands_, &command, sizeof command))
        while ((seen = poll(&ready, 1, static_cast<int>(1000.0 * most_seconds))) < 0 && errno == EINTR) {
        }
    if (seen == 0) {
        kill(child_, SIGKILL);
        end_of_child();
        set_text(answer.text, "over the time limit");
    } else if (!read_all(answers_, &answer, sizeof answer)) {
        answer = {};
        set_text(answer.text, end_of_child());
    }
    return answer;
}

}  // namespace clinch::peers
