#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "clinch/error.hpp"
#include "src/device/program_cache.hpp"
#include "tests/device/devices.hpp"

using namespace clinch;
using clinch::detail::ProgramCache;
namespace fs = std::filesystem;

namespace {

// An empty folder that goes with the test.
class Folder {
public:
    explicit Folder(const std::string& name) : path_(fs::temp_directory_path() / ("clinch-" + name)) {
        fs::remove_all(path_);
        fs::create_directories(path_);
    }
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    std::string path() const { return path_.string(); }
    std::vector<fs::path> files() const {
        std::vector<fs::path> found;
        for (const auto& entry : fs::directory_iterator(path_)) found.push_back(entry.path());
        return found;
    }

private:
    fs::path path_;
};

void overwrite(const fs::path& file, std::size_t at, char value) {
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(static_cast<std::streamoff>(at));
    stream.put(value);
}

// A context on device 0 alone that keeps kernels in `folder` and logs to `lines`.
Context logging_context(const std::string& folder, std::vector<std::string>& lines) {
    ContextOptions options;
    options.devices.indices = {0};
    options.kernel_cache = folder;
    options.log = [&lines](const std::string& line) { lines.push_back(line); };
    return Context(options);
}

std::size_t deletions(const std::vector<std::string>& lines) {
    std::size_t count = 0;
    for (const std::string& line : lines) count += line.find("deleted the kernel cache entry") == 0 ? 1U : 0U;
    return count;
}

}  // namespace

TEST_CASE("the program cache keeps binaries by their whole key", "[host]") {
    const Folder folder("cache-keys");
    const ProgramCache cache(folder.path(), nullptr);
    const std::vector<unsigned char> one{1, 2, 3, 0, 255}, two(100000, 7);
    CHECK_FALSE(cache.load("a").has_value());
    cache.store("a", one);
    cache.store("b", two);
    CHECK(cache.load("a") == one);
    CHECK(cache.load("b") == two);
    CHECK_FALSE(cache.load("c").has_value());
    cache.store("a", two);
    CHECK(cache.load("a") == two);
    CHECK(folder.files().size() == 2);  // nothing temporary is left
}

TEST_CASE("a damaged cache entry is logged and deleted wherever the damage is", "[host]") {
    const Folder folder("cache-damage");
    std::vector<std::string> lines;
    const ProgramCache cache(folder.path(), [&](const std::string& line) { lines.push_back(line); });
    const std::vector<unsigned char> binary(50, 9);
    cache.store("key", binary);
    const auto size = fs::file_size(cache.path("key"));
    for (std::size_t at = 0; at < size; ++at) {
        cache.store("key", binary);
        overwrite(cache.path("key"), at, '~');
        lines.clear();
        INFO("byte " << at);
        CHECK_FALSE(cache.load("key").has_value());
        CHECK(deletions(lines) == 1);
        CHECK_FALSE(fs::exists(cache.path("key")));
    }
    for (const std::size_t length : {std::size_t{0}, std::size_t{10}, static_cast<std::size_t>(size) - 1}) {
        cache.store("key", binary);
        fs::resize_file(cache.path("key"), length);
        CHECK_FALSE(cache.load("key").has_value());
        CHECK_FALSE(fs::exists(cache.path("key")));
    }
}

TEST_CASE("a cache that cannot be written costs no result", "[host]") {
    std::vector<std::string> lines;
    const ProgramCache cache("/dev/null/nowhere", [&](const std::string& line) { lines.push_back(line); });
    cache.store("key", {1});
    CHECK(lines.size() == 1);
    CHECK_FALSE(cache.load("key").has_value());
    const ProgramCache off("", nullptr);
    off.store("key", {1});
    CHECK_FALSE(off.load("key").has_value());
}

TEST_CASE("a cache entry that cannot be read, a folder in its place, costs no result", "[host]") {
    const Folder folder("cache-folder-entry");
    std::vector<std::string> lines;
    const ProgramCache cache(folder.path(), [&](const std::string& line) { lines.push_back(line); });
    fs::create_directories(cache.path("key") + "/in the way");
    CHECK_FALSE(cache.load("key").has_value());
    CHECK(deletions(lines) == 1);
    cache.store("key", {1, 2});
    CHECK(lines.size() == 2);
    CHECK_FALSE(cache.load("key").has_value());
    fs::remove_all(cache.path("key"));
    cache.store("key", {1, 2});
    CHECK(cache.load("key") == std::vector<unsigned char>{1, 2});
}

TEST_CASE("kernels are built once, then read from the cache, and built again when it is damaged", "[device]") {
    const Folder folder("cache-kernels");
    std::vector<std::string> lines;
    {
        const Context context = logging_context(folder.path(), lines);
        context.impl().open(0).kernel("primitives/scan", "scan_runs");
        CHECK(context.report()[0].modules_built == std::vector<std::string>{"primitives/scan"});
        CHECK(context.report()[0].modules_cached.empty());
    }
    REQUIRE(folder.files().size() == 1);
    {
        const Context context = logging_context(folder.path(), lines);
        context.impl().open(0).kernel("primitives/scan", "scan_runs");
        CHECK(context.report()[0].modules_built.empty());
        CHECK(context.report()[0].modules_cached == std::vector<std::string>{"primitives/scan"});
        CHECK(deletions(lines) == 0);
    }
    overwrite(folder.files()[0], static_cast<std::size_t>(fs::file_size(folder.files()[0])) / 2, '~');
    {
        const Context context = logging_context(folder.path(), lines);
        context.impl().open(0).kernel("primitives/scan", "scan_runs");
        CHECK(context.report()[0].modules_built == std::vector<std::string>{"primitives/scan"});
        CHECK(deletions(lines) == 1);
    }
    CHECK(folder.files().size() == 1);  // stored again
}

TEST_CASE("kernels come from CLINCH_KERNEL_DIR while developing", "[device]") {
    const Folder kernels("kernel-dir");
    fs::create_directories(kernels.path() + "/primitives");
    setenv("CLINCH_KERNEL_DIR", kernels.path().c_str(), 1);
    const Context context = test::with_lanes(0, 1);
    detail::Device& device = context.impl().open(0);
    try {
        device.kernel("primitives/scan", "scan_runs");
        FAIL("no error");
    } catch (const Error& error) {
        CHECK(error.code() == ErrorCode::FileFailed);
        CHECK(std::string(error.what()).find("scan.cl") != std::string::npos);
    }
    std::ofstream(kernels.path() + "/primitives/scan.cl") << "kernel void scan_runs(global uint* p) { p[0] = oops; }\n";
    try {
        device.kernel("primitives/scan", "scan_runs");
        FAIL("no error");
    } catch (const Error& error) {
        CHECK(error.code() == ErrorCode::BuildFailed);
        CHECK(error.build_log().find("oops") != std::string::npos);
        CHECK(std::string(error.what()).find("primitives/scan") != std::string::npos);
    }
    std::ofstream(kernels.path() + "/primitives/scan.cl") << "kernel void scan_runs(global uint* p) { p[0] = 17; }\n";
    detail::Kernel kernel = device.kernel("primitives/scan", "scan_runs");
    const detail::Buffer out = device.allocate(4, "a number");
    std::uint32_t value = 0;
    device.launch(kernel.args(out), 1, 1);
    device.read(out, &value, 4);
    CHECK(value == 17);
    unsetenv("CLINCH_KERNEL_DIR");
}
