// clinch devices: every platform and device.
#include <algorithm>
#include <cstdint>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "clinch/context.hpp"
#include "clinch/device.hpp"
#include "clinch/error.hpp"
#include "tools/io/text.hpp"
#include "tools/program/command.hpp"

namespace clinch::program {
namespace {

std::string memory_text(std::uint64_t bytes) {
    return std::to_string((bytes + (std::uint64_t{1} << 19)) >> 20) + " MiB";
}

nlohmann::ordered_json to_json(const DeviceInfo& d) {
    return {{"index", d.index},
            {"name", d.name},
            {"vendor", d.vendor},
            {"platform", d.platform},
            {"platform_version", d.platform_version},
            {"version", d.version},
            {"driver_version", d.driver_version},
            {"type", to_string(d.type)},
            {"compute_units", d.compute_units},
            {"clock_mhz", d.clock_mhz},
            {"lanes", d.lanes},
            {"global_memory", d.global_memory},
            {"max_allocation", d.max_allocation},
            {"local_memory", d.local_memory},
            {"fp64", d.fp64},
            {"unified_memory", d.unified_memory},
            {"quirks", d.quirks},
            {"use", d.use}};
}

using Row = std::vector<std::string>;

Row to_row(const DeviceInfo& d) {
    return {std::to_string(d.index),
            to_string(d.type),
            d.platform,
            d.name,
            std::to_string(d.compute_units),
            std::to_string(d.lanes),
            memory_text(d.global_memory),
            d.fp64 ? "yes" : "no",
            d.quirks.empty() ? "none" : io::join(d.quirks),
            d.use};
}

void print_table(const std::vector<Row>& rows) {
    std::vector<std::size_t> widths(rows.front().size(), 0);
    for (const Row& row : rows)
        for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
    for (const Row& row : rows) {
        std::string line;
        for (std::size_t c = 0; c < row.size(); ++c) {
            line += row[c];
            if (c + 1 < row.size()) line.append(widths[c] - row[c].size() + 2, ' ');
        }
        std::cout << line << '\n';
    }
}

/// Says on standard error what was looked for and what to install, in the library's own words.
void explain_lack() {
    try {
        const Context context;
    } catch (const Error& e) {
        std::cerr << "clinch: " << e.what() << '\n';
    }
}

int run(bool json) {
    const std::vector<DeviceInfo> devices = list_devices();
    if (json) {
        nlohmann::ordered_json list = nlohmann::ordered_json::array();
        for (const DeviceInfo& device : devices) list.push_back(to_json(device));
        std::cout << list.dump(2) << '\n';
    } else {
        std::vector<Row> rows{
            {"index", "type", "platform", "name", "units", "lanes", "memory", "fp64", "quirks", "use"}};
        for (const DeviceInfo& device : devices) rows.push_back(to_row(device));
        print_table(rows);
    }
    if (devices.empty()) explain_lack();
    return devices.empty() ? 1 : 0;
}

}  // namespace

Command add_devices_command(CLI::App& app) {
    auto json = std::make_shared<bool>(false);
    CLI::App* const command = app.add_subcommand("devices", "List every OpenCL device and what it would be used for");
    command->add_flag("--json", *json, "All fields, as a JSON list");
    return {command, [json] { return run(*json); }};
}

}  // namespace clinch::program
