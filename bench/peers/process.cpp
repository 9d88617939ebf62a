#include "bench/peers/process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <cerrno>
#include <csignal>
#include <cstring>
#include <system_error>

namespace clinch::peers {
namespace {

[[noreturn]] void fail(const char* what) {
    throw std::system_error(errno, std::generic_category(), what);
}

/// What libraries print would stand between our lines.
void silence() {
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (nowhere < 0) return;
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
}

[[noreturn]] void be_child(const std::function<void(int, int)>& serve, int commands, int answers) {
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
    silence();
    serve(commands, answers);
    _exit(0);  // libraries' ends of program have nothing to say here
}

}  // namespace

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

std::uint64_t peak_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

Process::Process(const std::function<void(int commands, int answers)>& serve) {
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
        be_child(serve, commands[0], answers[1]);
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

// Other processes may hold copies of the pipes, so that closing them tells the child nothing.
Process::~Process() {
    if (child_ > 0) {
        kill(child_, SIGKILL);
        end_of_child();
    }
    close(commands_);
    close(answers_);
}

std::string Process::end_of_child() {
    int status = 0;
    while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    child_ = -1;
    if (WIFSIGNALED(status)) return std::string("crashed: ") + strsignal(WTERMSIG(status));
    return "ended with status " + std::to_string(WEXITSTATUS(status));
}

std::string Process::ask(const void* command, std::size_t command_bytes, void* answer, std::size_t answer_bytes,
                         double most_seconds) {
    if (child_ <= 0) return "has ended";
    pollfd ready{answers_, POLLIN, 0};
    int seen = 1;
    if (write_all(commands_, command, command_bytes))
        while ((seen = poll(&ready, 1, static_cast<int>(1000.0 * most_seconds))) < 0 && errno == EINTR) {
        }
    if (seen == 0) {
        kill(child_, SIGKILL);
        end_of_child();
        return "over the time limit";
    }
    return read_all(answers_, answer, answer_bytes) ? std::string{} : end_of_child();
}

}  // namespace clinch::peers
