#include "src/device/program_cache.hpp"

#include <array>
#include <boost/uuid/detail/sha1.hpp>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <istream>
#include <random>
#include <string_view>
#include <utility>

namespace clinch::detail {
namespace {

namespace fs = std::filesystem;

std::string sha1(const void* data, std::size_t size) {
    boost::uuids::detail::sha1 hash;
    hash.process_bytes(data, size);
    boost::uuids::detail::sha1::digest_type digest;
    hash.get_digest(digest);
    std::string text;
    for (const unsigned int word : digest) {
        std::array<char, 9> hex{};
        std::snprintf(hex.data(), hex.size(), "%08x", word);
        text += hex.data();
    }
    return text;
}

// Entry: magic, sha1 of all that follows, length of key, key, binary.
constexpr std::string_view magic = "clinch kernel 1\n";
constexpr std::size_t sha1_length = 40;
constexpr std::size_t header_length = magic.size() + sha1_length;

std::string body_of(const std::string& key, const std::vector<unsigned char>& binary) {
    const std::uint64_t length = key.size();
    std::string body(sizeof length, '\0');
    std::memcpy(body.data(), &length, sizeof length);
    body += key;
    body.append(binary.begin(), binary.end());
    return body;
}

// The whole of a file; empty where it cannot be read. Reading by stream buffer would throw then.
std::string content_of(std::istream& file) {
    std::string content;
    std::array<char, 1 << 16> block{};
    while (file.read(block.data(), block.size()) || file.gcount() > 0)
        content.append(block.data(), static_cast<std::size_t>(file.gcount()));
    return file.bad() ? std::string() : content;
}

// Takes an entry apart; empty if anything about it is wrong.
std::optional<std::vector<unsigned char>> parse(const std::string& entry, const std::string& key) {
    if (entry.size() < header_length + sizeof(std::uint64_t) || entry.compare(0, magic.size(), magic) != 0) return {};
    const char* body = entry.data() + header_length;
    const std::size_t size = entry.size() - header_length;
    if (entry.compare(magic.size(), sha1_length, sha1(body, size)) != 0) return {};
    std::uint64_t length = 0;
    std::memcpy(&length, body, sizeof length);
    if (length != key.size() || size < sizeof length + length) return {};
    if (std::memcmp(body + sizeof length, key.data(), key.size()) != 0) return {};
    return std::vector<unsigned char>(body + sizeof length + length, body + size);
}

}  // namespace

ProgramCache::ProgramCache(std::string folder, Log log) : folder_(std::move(folder)), log_(std::move(log)) {}

void ProgramCache::log(const std::string& line) const {
    if (log_) log_(line);
}

std::string ProgramCache::path(const std::string& key) const {
    return (fs::path(folder_) / (sha1(key.data(), key.size()) + ".clk")).string();
}

std::optional<std::vector<unsigned char>> ProgramCache::load(const std::string& key) const {
    if (folder_.empty()) return {};
    std::ifstream file(path(key), std::ios::binary);
    if (!file) return {};
    auto binary = parse(content_of(file), key);
    if (!binary) discard(key, "it is damaged");
    return binary;
}

void ProgramCache::discard(const std::string& key, const std::string& why) const {
    if (folder_.empty()) return;
    log("deleted the kernel cache entry '" + path(key) + "': " + why + "; the kernel is built again");
    std::error_code ignored;
    fs::remove(path(key), ignored);
}

void ProgramCache::store(const std::string& key, const std::vector<unsigned char>& binary) const {
    if (folder_.empty() || binary.empty()) return;
    std::error_code error;
    fs::create_directories(folder_, error);
    const std::string target = path(key);
    const std::string temporary = target + "." + std::to_string(std::random_device{}()) + ".tmp";
    const std::string body = body_of(key, binary);
    {
        std::ofstream file(temporary, std::ios::binary);
        file << magic << sha1(body.data(), body.size()) << body;
        file.close();
        if (!file) error = std::make_error_code(std::errc::io_error);
    }
    if (!error) fs::rename(temporary, target, error);
    if (!error) return;
    log("cannot keep a compiled kernel in '" + folder_ + "': " + error.message());
    fs::remove(temporary, error);
}

std::string default_cache_folder() {
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache != '\0')
        return (fs::path(cache) / "clinch").string();
    if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
        return (fs::path(home) / ".cache" / "clinch").string();
    return {};
}

}  // namespace clinch::detail
