#include "src/device/kernel_sources.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string_view>

#include "clinch/error.hpp"

namespace clinch::detail {
namespace {

std::string read_from_folder(const std::filesystem::path& folder, const std::string& path) {
    std::ifstream file(folder / path, std::ios::binary);
    std::ostringstream text;
    for (char c = 0; file.get(c);) text.put(c);  // not by stream buffer, which throws what is no Error
    if (!file.eof() || file.bad())
        throw Error(ErrorCode::FileFailed,
                    "cannot read the kernel file '" + (folder / path).string() + "' (CLINCH_KERNEL_DIR is set)");
    return text.str();
}

std::string read_kernel_file(const std::string& path) {
    if (const char* folder = std::getenv("CLINCH_KERNEL_DIR"); folder != nullptr && *folder != '\0')
        return read_from_folder(folder, path);
    for (std::size_t i = 0; i < embedded_kernel_count; ++i)
        if (path == embedded_kernels[i].path) return embedded_kernels[i].text;
    throw Error(ErrorCode::FileFailed, "there is no kernel file '" + path + "' in the library");
}

// Appends `text` and the files it includes; `seen` holds the files already in.
void append(const std::string& text, std::set<std::string>& seen, std::string& out) {
    std::istringstream lines(text);
    constexpr std::string_view directive = "#include \"";
    for (std::string line; std::getline(lines, line);) {
        if (line.compare(0, directive.size(), directive) != 0) {
            out += line + '\n';
            continue;
        }
        const std::string path = line.substr(directive.size(), line.rfind('"') - directive.size());
        if (seen.insert(path).second) append(read_kernel_file(path), seen, out);
    }
}

}  // namespace

std::string kernel_source(const std::string& module) {
    return with_includes(read_kernel_file(module + ".cl"));
}

std::string with_includes(const std::string& text) {
    std::set<std::string> seen;
    std::string out;
    append(text, seen, out);
    return out;
}

std::size_t kernel_module_count() {
    std::size_t count = 0;
    for (std::size_t i = 0; i < embedded_kernel_count; ++i)
        count += std::filesystem::path(embedded_kernels[i].path).extension() == ".cl" ? 1U : 0U;
    return count;
}

}  // namespace clinch::detail
