#include "tools/io/table_format.hpp"

#include "tools/io/error.hpp"
#include "tools/io/text.hpp"

namespace clinch::io {

TableFormat table_format(const std::string& path) {
    if (path == "-") return TableFormat::Csv;
    const std::string end = ending(path);
    if (end == ".npy") return TableFormat::Npy;
    if (end == ".csv") return TableFormat::Csv;
    throw InputError("-o: '" + path + "' has the ending '" + end +
                     "'; .npy, .csv, or - for standard output are accepted");
}

}  // namespace clinch::io
