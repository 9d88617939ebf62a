#include "bench/peers/common.hpp"

#include <algorithm>
#include <cstddef>
#include <fstream>

namespace clinch::peers {

std::string processor() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.rfind("model name", 0) == 0 && line.find(": ") != std::string::npos)
            return line.substr(line.find(": ") + 2);
    return "unknown";
}

double median(std::vector<double> values) {
    if (values.empty()) return 0.0;
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 != 0 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

double least(const std::vector<double>& values) {
    return values.empty() ? 0.0 : *std::min_element(values.begin(), values.end());
}

bool begins_with_any(const std::string& name, const std::vector<std::string>& with) {
    return std::any_of(with.begin(), with.end(), [&](const std::string& w) { return name.rfind(w, 0) == 0; });
}

}  // namespace clinch::peers
