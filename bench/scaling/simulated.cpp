#include <algorithm>
#include <cstdint>
#include <functional>
#include <utility>

#include "bench/machines/machine.hpp"
#include "bench/machines/simulation.hpp"
#include "bench/scaling/curve.hpp"

namespace clinch::scaling {

namespace {

constexpr int settling = 12, timed = 8;  // steps: until the shares have settled, and then
constexpr std::size_t chunks_each = 64;  // a device
constexpr double noise = 0.1, spread = 0.3;

using MakeMachine = std::function<machines::Machine(std::size_t)>;
using MakeLoad = std::function<machines::Load(std::uint32_t)>;

Curve curve(const std::pair<std::string, MakeMachine>& devices, const std::pair<double, MakeLoad>& load,
            std::size_t most, std::uint64_t seed) {
    Curve found{{}, devices.first, load.first, {}};
    std::vector<std::size_t> counts;
    for (const std::size_t count : {1u, 2u, 3u, 4u, 6u, 8u, 12u, 16u, 24u, 32u, 48u, 64u})
        if (count <= most) counts.push_back(count);
    for (const std::size_t count : counts) {
        machines::Machine machine = devices.second(count);
        machine.noise = noise;
        const machines::Load work = load.second(static_cast<std::uint32_t>(chunks_each * count));
        machines::Simulation simulation(machine, seed);
        for (int i = 0; i < settling; ++i) simulation.step(work);
        Point point{count, 0.0, machines::ideal_seconds(machine, work), 0.0};
        for (int i = 0; i < timed; ++i) {
            const machines::Step step = simulation.step(work);
            point.seconds += step.seconds / timed;
            point.stolen += step.stolen / timed;
        }
        found.load = work.name;
        found.points.push_back(point);
    }
    return found;
}

}  // namespace

Machine simulated(std::size_t most, unsigned long long seed) {
    Machine result{
        "simulated",
        "bench/machines",
        {"each device: a link of 12 GB/s each way, 30 us a step and 10 us a chunk to begin",
         "the host's memory moves 400 GB/s unless said otherwise, all transfers and the copy of the results together",
         "results are put one behind the other; nothing is merged pair by pair",
         "density: 45 ns and 24 bytes a box, 3 ns and 8 bytes a pair at speed 1, a pair a body",
         "density: a chunk's work and pairs differ by up to 30 %; no box lies in two chunks",
         "cubes: 0.1 ns a test at speed 1, all boxes sent to every device, a pair a body",
         "64 chunks a device; a device takes up to 10 % longer for a step, another part each step; means of 8 steps"},
        {}};
    const MakeMachine equal = machines::equal_machine;
    const MakeMachine unlike = [seed](std::size_t count) { return machines::unlike_machine(count, 1.0, 8.0, seed); };
    const MakeMachine shared = [seed](std::size_t count) {
        machines::Machine machine = machines::unlike_machine(count, 1.0, 8.0, seed);
        machine.host.memory_bandwidth = 100e9;
        return machine;
    };
    const MakeLoad dense = [seed](std::uint32_t chunks) { return machines::density(100e6, chunks, spread, seed); };
    const MakeLoad brute = [](std::uint32_t chunks) { return machines::cubes(1e6, chunks); };
    result.curves.push_back(curve({"equal", equal}, {1e6, brute}, most, seed));
    result.curves.push_back(curve({"equal", equal}, {100e6, dense}, most, seed));
    result.curves.push_back(curve({"speeds 1 to 8", unlike}, {100e6, dense}, most, seed));
    result.curves.push_back(curve({"speeds 1 to 8, host 100 GB/s", shared}, {100e6, dense}, most, seed));
    return result;
}

}  // namespace clinch::scaling
