// The program `clinch`: see --help.
#include <CLI/CLI.hpp>
#include <array>
#include <exception>
#include <iostream>
#include <new>
#include <string>

#include "clinch/error.hpp"
#include "clinch/version.hpp"
#include "tools/io/error.hpp"
#include "tools/program/command.hpp"

namespace clinch::program {
namespace {

constexpr int failed = 1, wrong_input = 2;

int report(const std::string& message, int status) {
    std::cerr << "clinch: " << message << '\n';
    return status;
}

int run(int count, const char* const* arguments) {
    CLI::App app("Finds which of very many 3D bodies touch, on OpenCL devices.", "clinch");
    app.set_version_flag("--version", CLINCH_VERSION);
    app.require_subcommand(1);
    const std::array<Command, 3> commands{add_devices_command(app), add_pairs_command(app), add_scene_command(app)};
    try {
        app.parse(count, arguments);
    } catch (const CLI::Success& asked_for_text) {
        return app.exit(asked_for_text);
    } catch (const CLI::ParseError& e) {
        std::string help = "clinch";
        for (const Command& command : commands)
            if (command.app->count() > 0) help += ' ' + command.app->get_name();
        return report(std::string(e.what()) + "; '" + help + " --help' shows what is accepted", wrong_input);
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
