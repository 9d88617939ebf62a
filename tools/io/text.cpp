#include "tools/io/text.hpp"

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "tools/io/error.hpp"

namespace clinch::io {
namespace {

template <class Number>
std::string shortest(Number value) {
    if (std::isnan(value)) return "nan";  // without the sign that some hold
    std::array<char, 32> buffer{};
    const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    return {buffer.data(), result.ptr};
}

}  // namespace

std::string to_text(double value) {
    return shortest(value);
}
std::string to_text(float value) {
    return shortest(value);
}

std::string join(const std::vector<std::string>& words) {
    std::string all;
    for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
    return all;
}

std::string ending(const std::string& path) {
    std::string text = std::filesystem::path(path).extension().string();
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

std::uint64_t parse_whole(const std::string& text, const std::string& what, std::uint64_t low, std::uint64_t high) {
    std::uint64_t value = 0;
    const char* const last = text.data() + text.size();
    const auto result = std::from_chars(text.data(), last, value);
    if (result.ec == std::errc() && result.ptr == last && value >= low && value <= high) return value;
    throw InputError(what + " is '" + text + "'; a whole number from " + std::to_string(low) + " to " +
                     std::to_string(high) + " is accepted");
}

double parse_number(const std::string& text, const std::string& what, double low, double high) {
    double value = 0.0;
    const char* const last = text.data() + text.size();
    const auto result = std::from_chars(text.data(), last, value);
    if (result.ec == std::errc() && result.ptr == last && value >= low && value <= high) return value;
    throw InputError(what + " is '" + text + "'; a number from " + to_text(low) + " to " + to_text(high) +
                     " is accepted");
}

}  // namespace clinch::io
