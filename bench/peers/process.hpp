// A child process that answers commands: libraries that crash, hang or leave threads behind do so there.
#pragma once

#include <sys/types.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <string>
#include <type_traits>

namespace clinch::peers {

bool read_all(int from, void* to, std::size_t bytes);
bool write_all(int to, const void* from, std::size_t bytes);

/// Most memory this process has had, in bytes.
std::uint64_t peak_bytes();

/// Cut off where it does not fit.
template <std::size_t N>
void set_text(std::array<char, N>& to, const std::string& text) {
    to.fill('\0');
    std::copy_n(text.begin(), std::min(text.size(), N - 1), to.begin());
}

/// Replies to commands until there are no more. What a reply throws becomes the `text` of an answer.
template <class Command, class Answer, class Reply>
void answer_all(int commands, int answers, Reply reply) {
    static_assert(std::is_trivially_copyable_v<Command> && std::is_trivially_copyable_v<Answer>, "they cross a pipe");
    Command command{};
    while (read_all(commands, &command, sizeof command)) {
        Answer answer{};
        try {
            answer = reply(command);
        } catch (const std::exception& error) {
            set_text(answer.text, error.what());
        }
        if (!write_all(answers, &answer, sizeof answer)) return;
    }
}

/// A child and the two pipes to it. The process that makes it must not have used OpenCL, nor OpenMP with several
/// threads: those do not survive a fork. POSIX calls that fail are std::system_error.
class Process {
public:
    /// `serve` runs in the child, silenced, with the pipes that commands come from and answers go to; when it returns
    /// the child ends.
    explicit Process(const std::function<void(int commands, int answers)>& serve);
    /// Ends the child at once.
    ~Process();
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    /// Waits for the answer, at most so long. None: says why in `text` of it, and the child has ended.
    template <class Command, class Answer>
    Answer ask(const Command& command, double most_seconds) {
        static_assert(std::is_trivially_copyable_v<Command> && std::is_trivially_copyable_v<Answer>,
                      "they cross a pipe");
        Answer answer{};
        const std::string why = ask(&command, sizeof command, &answer, sizeof answer, most_seconds);
        if (why.empty()) return answer;
        answer = {};
        set_text(answer.text, why);
        return answer;
    }

private:
    std::string ask(const void* command, std::size_t command_bytes, void* answer, std::size_t answer_bytes,
                    double most_seconds);
    std::string end_of_child();

    pid_t child_ = -1;
    int commands_ = -1, answers_ = -1;
};

}  // namespace clinch::peers
