// clinch_scaling: how a step's time falls with the number of devices, as JSON. See bench/plot_scaling.py.
#include <CLI/CLI.hpp>
#include <exception>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "bench/scaling/curve.hpp"
#include "bench/scaling/unlike.hpp"

namespace {

using namespace clinch::scaling;
using Json = nlohmann::ordered_json;

Json to_json(const Curve& curve) {
    Json points = Json::array();
    for (const Point& point : curve.points)
        points.push_back({{"devices", point.devices},
                          {"seconds", point.seconds},
                          {"ideal_seconds", point.ideal_seconds},
                          {"efficiency", point.ideal_seconds / point.seconds},
                          {"stolen", point.stolen}});
    return {{"load", curve.load}, {"bodies", curve.bodies}, {"devices", curve.devices}, {"points", points}};
}

Json to_json(const Machine& machine) {
    Json curves = Json::array();
    for (const Curve& curve : machine.curves) curves.push_back(to_json(curve));
    return {
        {"machine", machine.machine}, {"name", machine.name}, {"assumptions", machine.assumptions}, {"curves", curves}};
}

Json to_json(const UnlikeCurve& curve) {
    Json steps = Json::array();
    for (const UnlikeStep& step : curve.steps)
        steps.push_back({{"seconds", step.seconds}, {"shares", step.shares}, {"device_seconds", step.device_seconds}});
    return {{"load", curve.load},
            {"bodies", curve.bodies},
            {"alone_seconds", curve.alone_seconds},
            {"ideal_seconds", curve.ideal_seconds},
            {"steps", steps}};
}

int run(int argc, char** argv) {
    CLI::App app("Writes time and efficiency of a step by the number of devices, as JSON");
    std::string path;
    std::size_t most = 64;
    unsigned long long seed = 1;
    app.add_option("-o,--output", path, "default: standard output");
    app.add_option("--devices", most, "at most; default 64")->check(CLI::Range(1, 64));
    bool measure = false, slow = false;
    app.add_flag("--real", measure, "also measure this machine's CPU, each core a device (a minute)");
    app.add_flag(
        "--unlike", slow,
        "also measure two devices of this CPU of which one is slowed to a quarter (minutes); with the environment "
        "POCL_DEVICES='pthread basic' the second is a device of its own");
    app.add_option("--seed", seed, "of speeds, work and noise; default 1");
    CLI11_PARSE(app, argc, argv);
    Json machines = Json::array({to_json(simulated(most, seed))});
    if (measure) {
        const std::optional<Machine> here = real(most);
        if (!here) throw std::runtime_error("--real needs PoCL, which has no CPU here");
        machines.push_back(to_json(*here));
    }
    Json content = {{"program", "clinch_scaling"}, {"seed", seed}, {"machines", machines}};
    if (slow) {
        const std::vector<UnlikeCurve> curves = unlike();
        if (curves.empty()) throw std::runtime_error("--unlike needs PoCL, with two cores or its device 'basic'");
        std::cerr << table(curves);
        for (const UnlikeCurve& curve : curves) content["unlike"].push_back(to_json(curve));
    }
    if (path.empty()) {
        std::cout << content.dump(1) << '\n';
        return 0;
    }
    std::ofstream file(path);
    file << content.dump(1) << '\n';
    file.close();
    if (!file) throw std::runtime_error("cannot write " + path);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run(argc, argv);
    } catch (const std::exception& error) {
        std::cerr << "clinch_scaling: " << error.what() << '\n';
        return 1;
    }
}
