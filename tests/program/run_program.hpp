// Runs the built program as a user does.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tests/io/temp_folder.hpp"

namespace clinch::test {

struct ProgramRun {
    int status = -1;  ///< exit status; 128 + signal if it was killed
    std::string out;
    std::string err;
    /// `err` without notes, which a device with a known fault of its driver brings forth.
    std::string complaints() const;
};

/// Runs the program named by the environment variable CLINCH_PROGRAM and waits for its end. `environment`
/// goes over the test's own, from which CLINCH_DEVICES is taken out.
ProgramRun run_program(const std::vector<std::string>& arguments,
                       const std::map<std::string, std::string>& environment = {});

/// The same through the shell, in which "$CLINCH_PROGRAM" is the program.
ProgramRun run_shell(const std::string& script, const std::map<std::string, std::string>& environment = {});

}  // namespace clinch::test
