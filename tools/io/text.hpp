// Small pieces of text: numbers, lists and file endings.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace clinch::io {

/// The shortest decimal text that reads back as the same number; "nan" and "inf" for those.
std::string to_text(double value);
std::string to_text(float value);

/// "a, b, c".
std::string join(const std::vector<std::string>& words);

/// The ending of a file's name in lower case with its dot (".npy"), or nothing.
std::string ending(const std::string& path);

/// Reads a whole number in [low, high] in decimal digits; anything else is InputError, which begins with
/// `what` ("--count").
std::uint64_t parse_whole(const std::string& text, const std::string& what, std::uint64_t low, std::uint64_t high);

/// Reads a finite number in [low, high]; anything else is InputError as above.
double parse_number(const std::string& text, const std::string& what, double low, double high);

}  // namespace clinch::io
