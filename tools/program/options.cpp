#include "tools/program/options.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "tools/io/error.hpp"
#include "tools/io/text.hpp"

namespace clinch::program {
namespace {

constexpr std::uint64_t most_repeats = 1000000;

std::vector<std::string> algorithm_names() {
    std::vector<std::string> names = broad_phase_names();
    names.insert(names.begin(), "auto");
    return names;
}

void check_algorithm(const std::string& name) {
    const std::vector<std::string> names = algorithm_names();
    if (std::find(names.begin(), names.end(), name) == names.end())
        throw io::InputError("--algorithm is '" + name + "'; " + io::join(names) + " are accepted");
}

/// Indices past the last device would otherwise be passed over in silence.
void check_devices(const DeviceFilter& filter) {
    if (filter.indices.empty()) return;
    const std::size_t found = list_devices().size();
    for (const std::uint32_t index : filter.indices)
        if (found > 0 && index >= found)
            throw io::InputError("--devices names device " + std::to_string(index) + "; 0 to " +
                                 std::to_string(found - 1) + " are there");
}

std::optional<double> check_tolerance(const std::string& text) {
    if (text.empty()) return std::nullopt;
    const double tolerance = io::parse_number(text, "--tolerance", 0.0, std::numeric_limits<double>::max());
    if (!(tolerance > 0.0)) throw io::InputError("--tolerance is '" + text + "'; a number above 0 is accepted");
    return tolerance;
}

}  // namespace

void add_step_options(CLI::App& command, StepTexts& t, bool narrow) {
    const std::string no_effect = narrow ? "" : "No effect on this command: ";
    command
        .add_option("--devices", t.devices,
                    "Devices to use: indices from 'clinch devices' (0,2), a type (cpu, gpu), or all")
        ->type_name("LIST")
        ->capture_default_str();
    command.add_option("--algorithm", t.algorithm, "Broad phase: " + io::join(algorithm_names()))
        ->type_name("NAME")
        ->capture_default_str();
    auto* precision =
        command.add_option("--precision", t.precision, no_effect + "narrow phase, 0 (fastest) to 1 (most exact)")
            ->type_name("P")
            ->capture_default_str();
    command
        .add_option("--tolerance", t.tolerance,
                    no_effect + "narrow phase, instead of --precision an absolute error in scene units, above 0")
        ->type_name("T")
        ->excludes(precision);
    command
        .add_option("--contacts-per-pair", t.contacts_per_pair,
                    no_effect + "most points of a pair's manifold, 1 to 8; the deepest is always there")
        ->type_name("K")
        ->capture_default_str();
    command.add_option("--order", t.order, "sorted, or any: rows as they come, faster, may differ from run to run")
        ->type_name("sorted|any")
        ->capture_default_str();
    command.add_option("--repeat", t.repeat, "Times the step is run, after a warming run, for timing")
        ->type_name("K")
        ->capture_default_str();
    command.add_option("--stats", t.stats, "Write statistics to this JSON file")->type_name("FILE");
    command.add_flag("--strict", t.strict, "A rejected body is an error instead of a warning");
    command.add_option("--seed", t.seed, "Seed of everything random (nothing is here)")
        ->type_name("S")
        ->capture_default_str();
}

StepOptions check_step_options(const StepTexts& t, bool narrow) {
    StepOptions options;
    check_algorithm(t.algorithm);
    options.algorithm = t.algorithm;
    options.host_only = t.algorithm.rfind("host-", 0) == 0;
    options.devices = DeviceFilter::parse(t.devices, "--devices");
    if (!options.host_only || narrow) check_devices(options.devices);
    options.narrow.precision = io::parse_number(t.precision, "--precision", 0.0, 1.0);
    options.narrow.tolerance = check_tolerance(t.tolerance);
    options.narrow.contacts_per_pair =
        static_cast<std::uint32_t>(io::parse_whole(t.contacts_per_pair, "--contacts-per-pair", 1, 8));
    if (t.order != "sorted" && t.order != "any")
        throw io::InputError("--order is '" + t.order + "'; sorted and any are accepted");
    options.order = t.order == "any" ? Order::Any : Order::Sorted;
    options.repeat = io::parse_whole(t.repeat, "--repeat", 1, most_repeats);
    io::parse_whole(t.seed, "--seed", 0, std::numeric_limits<std::uint64_t>::max());
    options.stats = t.stats;
    options.narrow.measure_stages = !t.stats.empty();
    options.strict = t.strict;
    return options;
}

}  // namespace clinch::program
