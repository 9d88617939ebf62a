// The two ways in which reading and writing files fail.
#pragma once

#include <stdexcept>

namespace clinch::io {

/// What the user gave is wrong: a file that is missing, unreadable or not of the form its ending
/// promises, or a wrong command. The message is one sentence that names the file, the field or index,
/// what was found and what is accepted. The program ends with status 2.
class InputError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// What was asked for is right and could not be done: a target that cannot be written, a full disk.
/// The program ends with status 1.
class OutputError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace clinch::io
