// Small things that the programs of this folder share.
#pragma once

#include <string>
#include <vector>

namespace clinch::peers {

/// As the system names it.
std::string processor();

/// 0 of none.
double median(std::vector<double> values);

/// 0 of none.
double least(const std::vector<double>& values);

/// Whether `name` begins with one of `with`.
bool begins_with_any(const std::string& name, const std::vector<std::string>& with);

}  // namespace clinch::peers
