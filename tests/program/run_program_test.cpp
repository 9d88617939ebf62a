#include "tests/program/run_program.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

namespace clinch::test {
namespace {

constexpr const char* variable = "CLINCH_PROGRAM";

std::string program_path() {
    const char* const path = std::getenv(variable);
    if (path == nullptr) throw std::runtime_error("the environment variable CLINCH_PROGRAM must name the program");
    return path;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> all;
    for (std::string& text : texts) all.push_back(text.data());
    all.push_back(nullptr);
    return all;
}

std::vector<std::string> merged_environment(std::map<std::string, std::string> changes) {
    changes.emplace("CLINCH_DEVICES", "");
    std::vector<std::string> entries;
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const std::string text = *entry;
        if (changes.count(text.substr(0, text.find('='))) == 0) entries.push_back(text);
    }
    for (const auto& [name, value] : changes) entries.emplace_back(name).append("=").append(value);
    return entries;
}

ProgramRun run(std::vector<std::string> arguments, const std::map<std::string, std::string>& environment) {
    const TempFolder folder;
    const std::string out = folder / "out", err = folder / "err";
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT, 0600);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT, 0600);
    std::vector<std::string> entries = merged_environment(environment);
    pid_t child = 0;
    const int failure = posix_spawn(&child, arguments[0].c_str(), &actions, nullptr, pointers(arguments).data(),
                                    pointers(entries).data());
    posix_spawn_file_actions_destroy(&actions);
    if (failure != 0) throw std::runtime_error("cannot start " + arguments[0]);
    int status = 0;
    if (waitpid(child, &status, 0) != child) throw std::runtime_error("cannot wait for " + arguments[0]);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), content(out), content(err)};
}

}  // namespace

std::string ProgramRun::complaints() const {
    std::string kept;
    std::istringstream lines(err);
    for (std::string line; std::getline(lines, line);)
        if (line.rfind("clinch: note: ", 0) != 0) kept += line + '\n';
    return kept;
}

ProgramRun run_program(const std::vector<std::string>& arguments,
                       const std::map<std::string, std::string>& environment) {
    std::vector<std::string> all{program_path()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return run(all, environment);
}

ProgramRun run_shell(const std::string& script, const std::map<std::string, std::string>& environment) {
    program_path();
    return run({"/bin/sh", "-c", script}, environment);
}

}  // namespace clinch::test

TEST_CASE("the program tells its version and commands", "[program]") {
    using Catch::Contains;
    using clinch::test::run_program;
    CHECK(run_program({"--version"}).out == "0.1.0\n");
    for (const char* const command : {"devices", "pairs", "scene"}) {
        INFO(command);
        CHECK_THAT(run_program({"--help"}).out, Contains(command));
        const auto help = run_program({command, "--help"});
        CHECK(help.status == 0);
        CHECK_THAT(help.out, Contains("--help"));
        CHECK(help.err.empty());
    }
}
