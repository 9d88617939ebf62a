#include "bench/machines/machine.hpp"

#include "bench/scenes/random.hpp"

namespace clinch::machines {

Machine equal_machine(std::size_t count) {
    Machine machine;
    machine.devices.resize(count);
    return machine;
}

Machine unlike_machine(std::size_t count, double low, double high, std::uint64_t seed) {
    Machine machine = equal_machine(count);
    scenes::Random random(seed);
    for (Device& device : machine.devices) device.speed = random.between(low, high);
    return machine;
}

Load cubes(double bodies, std::uint32_t chunks) {
    const double tests = bodies * (bodies - 1.0) / 2.0;
    const Load::Chunk chunk{tests * 0.1e-9 / chunks, 0.0, 8.0 * bodies / chunks};
    return {"cubes", 24.0 * bodies, std::vector<Load::Chunk>(chunks, chunk)};
}

Load density(double bodies, std::uint32_t chunks, double spread, std::uint64_t seed) {
    Load load{"density", 0.0, {}};
    scenes::Random random(seed);
    const double own = bodies / chunks;
    for (std::uint32_t i = 0; i < chunks; ++i) {
        const double work = random.between(1.0 - spread, 1.0 + spread);
        const double pairs = own * random.between(1.0 - spread, 1.0 + spread);
        load.chunks.push_back({own * 45e-9 * work + pairs * 3e-9, 24.0 * own, 8.0 * pairs});
    }
    return load;
}

double ideal_seconds(const Machine& machine, const Load& load) {
    double work = 0.0, speed = 0.0;
    for (const Load::Chunk& chunk : load.chunks) work += chunk.seconds;
    for (const Device& device : machine.devices) speed += device.speed;
    return work / speed;
}

}  // namespace clinch::machines
