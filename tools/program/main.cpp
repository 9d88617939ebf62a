// The program `clinch`: see --help.
#include <CLI/CLI.hpp>
#include <array>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include "clinch/error.hpp"
#include "clinch/version.hpp"
#include "tools/io/error.hpp"
#include "tools/io/text.hpp"
#include "tools/program/command.hpp"

namespace clinch::program {
namespace {

constexpr int failed = 1, wrong_input = 2;

int report(const std::string& message, int status) {
    std::cerr << "clinch: " << message << '\n';
    return status;
}

using Commands = std::array<Command, 4>;

/// What is wrong with the command line, and where to read what is right.
std::string usage_sentence(const CLI::App& app, const Commands& commands, const CLI::ParseError& e) {
    std::vector<std::string> names;
    std::string help = "clinch";
    for (const Command& command : commands) {
        names.push_back(command.app->get_name());
        if (command.app->count() > 0) help += ' ' + names.back();
    }
    if (app.get_subcommands().empty() && !app.remaining().empty())
        return "'" + app.remaining().front() + "' is no command; " + io::join(names) + " are accepted";
    return std::string(e.what()) + "; '" + help + " --help' shows what is accepted";
}

int run(int count, const char* const* arguments) {
    CLI::App app("Finds which of very many 3D bodies touch, on OpenCL devices.", "clinch");
    app.set_version_flag("--version", CLINCH_VERSION);
    app.require_subcommand(1);
    const Commands commands{add_devices_command(app), add_pairs_command(app), add_contacts_command(app),
                            add_scene_command(app)};
    try {
        app.parse(count, arguments);
    } catch (const CLI::Success& asked_for_text) {
        return app.exit(asked_for_text);
    } catch (const CLI::ParseError& e) {
        return report(usage_sentence(app, commands, e), wrong_input);
    }
    for (const Command& command : commands)
        if (command.app->parsed()) return command.run();
    return wrong_input;
}

int guarded(int count, const char* const* arguments) {
    try {
        return run(count, arguments);
    } catch (const io::InputError& e) {
        return report(e.what(), wrong_input);
    } catch (const Error& e) {
        if (!e.build_log().empty()) std::cerr << e.build_log() << '\n';
        return report(e.what(), e.code() == ErrorCode::InvalidArgument ? wrong_input : failed);
    } catch (const std::bad_alloc&) {
        return report("there is not enough memory on this machine for this input", failed);
    } catch (const std::exception& e) {
        return report(e.what(), failed);
    }
}

}  // namespace
}  // namespace clinch::program

int main(int count, char** arguments) {
    return clinch::program::guarded(count, arguments);
}
