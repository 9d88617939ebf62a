// The sharing of work on simulated machines: assumptions in bench/machines/machine.hpp.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

#include "bench/machines/machine.hpp"
#include "bench/machines/phases.hpp"
#include "bench/machines/simulation.hpp"

using namespace clinch;
using machines::Load;
using machines::Machine;
using machines::Simulation;
using machines::Step;

namespace {

constexpr std::uint64_t seed = 901;
constexpr int steps = 12;

std::uint32_t taken(const Step& step) {
    std::uint32_t sum = 0;
    for (const Step::Of& device : step.devices) sum += device.taken;
    return sum;
}

double efficiency(const Machine& machine, const Load& load) {
    const Step step = machines::settled(machine, load, steps, seed);
    CHECK(step.left == 0);
    CHECK(taken(step) == load.chunks.size());
    return machines::ideal_seconds(machine, load) / step.seconds;
}

}  // namespace

TEST_CASE("simulated: four equal devices do the cubes 3.5 times as fast", "[host][schedule]") {
    for (const double bodies : {30e3, 100e3, 1e6})
        for (const double noise : {0.0, 0.05}) {
            INFO("seed " << seed << ", bodies " << bodies << ", noise " << noise);
            const Load load = machines::cubes(bodies, 128);
            Machine one = machines::equal_machine(1), four = machines::equal_machine(4);
            one.noise = four.noise = noise;
            const double alone = machines::settled(one, load, steps, seed).seconds;
            CHECK(alone >= 3.5 * machines::settled(four, load, steps, seed).seconds);
        }
}

TEST_CASE("simulated: 64 unlike devices reach 80 % of the ideal with 100 M boxes", "[host][schedule]") {
    INFO("seed " << seed);
    const Load load = machines::density(100e6, 4096, 0.3, seed);
    Machine machine = machines::unlike_machine(64, 1.0, 8.0, seed);
    CHECK(efficiency(machine, load) >= 0.8);
    machine.noise = 0.1;
    CHECK(efficiency(machine, load) >= 0.8);

    SECTION("not where the host's memory is too slow for the transfers") {
        machine.host.memory_bandwidth = 100e9;
        CHECK(efficiency(machine, load) < 0.5);
    }
    SECTION("nor where one thread merges the results pair by pair") {
        machine.host.merge_seconds_a_byte = 5e-9 / 8.0;
        CHECK(efficiency(machine, load) < 0.1);
    }
}

TEST_CASE("simulated: efficiency by the number of devices", "[host][schedule]") {
    for (const std::size_t count : {2u, 3u, 4u, 8u, 16u, 32u, 64u}) {
        INFO("seed " << seed << ", devices " << count);
        const auto chunks = static_cast<std::uint32_t>(64 * count);
        const Load load = machines::density(100e6, chunks, 0.3, seed);
        CHECK(efficiency(machines::equal_machine(count), load) >= 0.9);
        CHECK(efficiency(machines::unlike_machine(count, 1.0, 8.0, seed), load) >= 0.8);
        const double found = efficiency(machines::equal_machine(count), machines::cubes(1e6, chunks));
        CHECK(found >= 0.9);
        CHECK(found <= 1.0);
    }
}

TEST_CASE("simulated: stealing makes up for shares that are wrong", "[host][schedule]") {
    INFO("seed " << seed);
    const Load load = machines::density(10e6, 256, 0.3, seed);
    const Machine machine{{{1.0}, {8.0}}, {}, 0.0};
    const Step first = machines::settled(machine, load, 1, seed);  // half each: nothing was measured
    CHECK(first.devices[1].stolen > 64);
    CHECK(first.seconds <= 1.15 * machines::ideal_seconds(machine, load));
    const Step later = machines::settled(machine, load, steps, seed);
    CHECK(later.stolen < 0.1);
}

TEST_CASE("simulated: stealing that costs a long transfer is left", "[host][schedule]") {
    // The second device must be sent 2.4 GB first, over a slow link: 24 s for work of half a second.
    Load load = machines::density(10e6, 64, 0.3, seed);
    load.bytes_to_begin = 2.4e9;
    Machine machine = machines::equal_machine(2);
    machine.devices[0].bandwidth = 1e12;
    machine.devices[1].bandwidth = 1e8;
    Simulation simulation(machine, seed);
    simulation.step(load);  // when this becomes known
    int used = 0;
    for (int i = 0; i < 30; ++i) {
        const Step step = simulation.step(load);
        CHECK(step.devices[1].stolen == 0);
        if (step.devices[1].taken > 0)
            ++used;
        else
            CHECK(step.seconds <= 1.05 * 10e6 * 48e-9);
    }
    CHECK(used <= 5);  // it is tried again ever more rarely
}

TEST_CASE("simulated: a device that fails leaves its chunks to the others", "[host][schedule]") {
    INFO("seed " << seed);
    const Load load = machines::density(10e6, 256, 0.3, seed);
    Machine machine = machines::unlike_machine(4, 1.0, 8.0, seed);
    const double whole = machines::ideal_seconds(machine, load);
    for (const double at : {0.0, 0.3, 0.9, 0.99}) {
        INFO("after " << at << " of the first step");
        machine.devices[2].fails_at = at * whole;
        Simulation simulation(machine, seed);
        const Step first = simulation.step(load);
        CHECK(first.left == 0);
        CHECK(taken(first) == 256);
        const Step next = simulation.step(load);
        CHECK(next.left == 0);
        CHECK(next.devices[2].taken == 0);
        CHECK(simulation.shares().fractions()[2] == 0.0);
        CHECK(simulation.clock().now() == Approx(first.seconds + next.seconds));
    }
    for (machines::Device& device : machine.devices) device.fails_at = 0.5 * whole;
    const Step step = machines::settled(machine, load, 1, seed);
    CHECK(step.left > 0);
    CHECK(step.left + taken(step) == 256);
}

TEST_CASE("simulated: the same seed gives the same steps", "[host][schedule]") {
    Machine machine = machines::unlike_machine(9, 1.0, 8.0, seed);
    machine.noise = 0.1;
    const Load load = machines::density(1e6, 300, 0.5, seed);
    const Step a = machines::settled(machine, load, 5, seed), b = machines::settled(machine, load, 5, seed);
    CHECK(a.seconds == b.seconds);
    CHECK(a.stolen == b.stolen);
    CHECK(machines::settled(machine, load, 5, seed + 1).seconds != a.seconds);
}

TEST_CASE("simulated: streaming overlaps the phases, and the buffer bounds it", "[host][schedule]") {
    const machines::Stream how{64, 4, 0.0};
    const machines::PhaseStep equal = machines::stream({1.0, 1.0}, how, 1, 2);
    CHECK(equal.seconds == Approx(1.0 + 1.0 / 64));  // the narrow phase begins a chunk later
    CHECK(equal.busy.broad == Approx(1.0));
    const machines::PhaseStep late = machines::stream({1.0, 3.0}, how, 1, 2);
    CHECK(late.seconds == Approx(3.0 + 1.0 / 64));
    CHECK(machines::stream({3.0, 1.0}, how, 1, 2).seconds == Approx(3.0 + 1.0 / 64));
}

TEST_CASE("simulated: the phases' split follows a falling scene", "[host][schedule]") {
    const std::vector<machines::PhaseLoad> scene = machines::falling_scene(600, 0.2);
    for (const unsigned units : {2u, 4u, 8u, 16u, 64u})
        for (const double noise : {0.0, 0.05})
            for (const auto measured : {machines::Measured::OnlyChecked, machines::Measured::EveryStep}) {
                INFO("seed " << seed << ", units " << units << ", noise " << noise << ", every step measured "
                             << (measured == machines::Measured::EveryStep));
                const machines::Balanced found = machines::balance(scene, {}, units, noise, seed, measured);
                std::size_t good = 0;
                std::uint64_t moves = 0;
                for (std::size_t i = 0; i < scene.size(); ++i) {
                    if (found.seconds[i] <= 1.1 * found.best[i]) ++good;
                    CHECK(found.seconds[i] == machines::stream(scene[i], {}, found.broad_units[i], units).seconds);
                    if (i > 0 && found.broad_units[i] != found.broad_units[i - 1]) ++moves;
                }
                CHECK(10 * good >= 9 * scene.size());
                CHECK(found.checks < scene.size());
                CHECK(found.moves - moves <= 1);  // the last one is for a step that does not come
            }
}
