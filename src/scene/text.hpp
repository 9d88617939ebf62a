// Numbers in messages.
#pragma once

#include <cmath>
#include <cstdio>
#include <string>

namespace clinch::detail {

/// A number with as many digits as a reader needs ("-1", "1.00213", "NaN").
inline std::string text(double x) {
    if (std::isnan(x)) return "NaN";
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%.9g", x);
    return buffer;
}
inline std::string text(const char* what, double x, const char* rule) {
    return std::string(what) + " is " + text(x) + " and must be " + rule;
}

}  // namespace clinch::detail
