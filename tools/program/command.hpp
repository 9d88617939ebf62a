// The subcommands of the program, one file each.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace clinch::program {

/// A subcommand that has been added to the command line: if `app` was parsed, `run` does its job and
/// returns the exit status. Failures leave it as exceptions.
struct Command {
    CLI::App* app;
    std::function<int()> run;
};

Command add_devices_command(CLI::App& app);
Command add_pairs_command(CLI::App& app);
Command add_contacts_command(CLI::App& app);
Command add_scene_command(CLI::App& app);

}  // namespace clinch::program
