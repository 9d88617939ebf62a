// The text of the kernels: embedded at build time, or read from CLINCH_KERNEL_DIR while developing.
#pragma once

#include <cstddef>
#include <string>

namespace clinch::detail {

/// One file of cl/: its path below cl/ and its text. Filled in by the build.
struct EmbeddedKernel {
    const char* path;
    const char* text;
};
extern const EmbeddedKernel embedded_kernels[];
extern const std::size_t embedded_kernel_count;

/// The whole source of a module ("broad_phase/brute" is broad_phase/brute.cl), includes resolved. A
/// file that is missing or unreadable is FileFailed.
std::string kernel_source(const std::string& module);

/// `text` with each #include "..." of a file of cl/ replaced, once, by that file's text.
std::string with_includes(const std::string& text);

/// How many modules (.cl files) there are.
std::size_t kernel_module_count();

}  // namespace clinch::detail
