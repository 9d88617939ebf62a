// clinch_accuracy: how fast and how right the routines of the narrow phase are, cell by cell of the matrix.
#include <CLI/CLI.hpp>
#include <exception>
#include <fstream>
#include <iostream>
#include <memory>

#include "bench/accuracy/report.hpp"
#include "clinch/device.hpp"

namespace {

using namespace clinch;
using namespace clinch::accuracy;

struct Arguments {
    Options options;
    std::string json, table;
    bool no_device = false;
    std::vector<std::string> cells;
};

void parse(CLI::App& app, Arguments& a) {
    app.add_flag("--quick", a.options.quick, "few pairs, the ends of each axis, no device: seconds instead of minutes");
    app.add_flag("--no-device", a.no_device, "only what runs on the host");
    app.add_option("--json", a.json, "write everything measured to this file");
    app.add_option("--table", a.table, "write the table that the library is built with to this file; needs a device");
    app.add_option("--seed", a.options.seed, "of all poses; default 1");
    app.add_option("--pairs", a.options.pairs, "poses a setting; default 40, with --quick 4");
    app.add_option("--cells", a.cells, "only these, as sphere-box,box-box")->delimiter(',');
}

void settle(Arguments& a) {
    Options& o = a.options;
    if (o.pairs == 0) o.pairs = o.quick ? 4 : 40;
    o.mixture = 8 * o.pairs;
    o.device_pairs = 32768;
    o.least_seconds = o.quick ? 0 : 1e-3;
    a.no_device = a.no_device || o.quick;
}

bool chosen(const Arguments& a, const std::string& classes) {
    return a.cells.empty() || std::find(a.cells.begin(), a.cells.end(), classes) != a.cells.end();
}

template <class Write>
void write_file(const std::string& path, const Write& write) {
    if (path.empty()) return;
    std::ofstream file(path);
    write(file);
    file.close();
    if (!file) throw std::runtime_error("cannot write " + path);
}

int run(int argc, char** argv) {
    CLI::App app("Measures the time and the error of each narrow-phase routine");
    Arguments arguments;
    parse(app, arguments);
    CLI11_PARSE(app, argc, argv);
    settle(arguments);
    std::unique_ptr<Context> context;
    std::string device;
    if (!arguments.no_device) {
        context = std::make_unique<Context>();
        if (context->devices().empty()) throw std::runtime_error("there is no OpenCL device; see --no-device");
        device = context->devices()[0].name;
        arguments.options.context = context.get();
    }
    if (!arguments.table.empty() && (context == nullptr || !arguments.cells.empty()))
        throw std::runtime_error("--table needs a device and all cells");
    std::vector<CellResult> cells;
    for (int a = 0; a < 7; ++a)
        for (int b = a; b < 7; ++b) {
            const auto kind_a = static_cast<test::Kind>(a), kind_b = static_cast<test::Kind>(b);
            if (kind_a == test::Kind::plane && kind_b == test::Kind::plane) continue;
            CellResult empty;
            empty.a = kind_a;
            empty.b = kind_b;
            if (!chosen(arguments, classes_of(empty))) continue;
            cells.push_back(measure_cell(kind_a, kind_b, arguments.options));
            std::cerr << classes_of(cells.back()) << " (seed " << cells.back().seed << ")\n";
        }
    write_file(arguments.json,
               [&](std::ostream& out) { out << json_of(cells, arguments.options, device).dump(1) << '\n'; });
    write_file(arguments.table, [&](std::ostream& out) { write_table(cells, out); });
    write_summary(cells, std::cout);
    const std::size_t wrong = faults(cells);
    if (wrong > 0) std::cerr << "clinch_accuracy: " << wrong << " broken promises, NaN or contradicting references\n";
    return wrong > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        std::cerr << "clinch_accuracy: " << error.what() << '\n';
        return 2;
    }
}
