// What a simulated machine is made of, and what its devices are given to do.
//
// Assumptions, none of them measured on such a machine: what a transfer takes is bytes over bandwidth, up and down at
// the same time, each device with a link of its own; all transfers and copies share the host's memory, first come first
// served; a device computes one chunk while the next one is sent; speeds differ by a constant factor. Times for one box
// and one pair are given to one significant digit for a device of speed 1.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace clinch::machines {

struct Device {
    double speed = 1.0;            ///< seconds of work (told for speed 1) done in a second
    double begin_seconds = 30e-6;  ///< a step: until it does anything (to enqueue and wait for a kernel on PoCL: 31 us)
    double launch_seconds = 10e-6;                              ///< a chunk (assumed)
    double bandwidth = 12e9;                                    ///< bytes a second each way (assumed: PCIe 3, 16 lanes)
    double fails_at = std::numeric_limits<double>::infinity();  ///< seconds after the begin of its first step
};

struct Host {
    double memory_bandwidth = 400e9;    ///< bytes a second, of all transfers and copies together (assumed: two sockets)
    double merge_seconds_a_byte = 0.0;  ///< by one thread besides the copy; 0: results are put one behind the other
};

struct Machine {
    std::vector<Device> devices;
    Host host{};
    double noise = 0.0;  ///< a device takes longer for all of a step by this part at most, another each step
};

/// `count` devices of speed 1; or of speeds in [low, high], the same for the same seed and any count.
Machine equal_machine(std::size_t count);
Machine unlike_machine(std::size_t count, double low, double high, std::uint64_t seed);

/// One step's work.
struct Load {
    struct Chunk {
        double seconds;  ///< at speed 1
        double bytes_up, bytes_down;
    };
    std::string name;
    double bytes_to_begin = 0.0;  ///< what every device must hold before its first chunk
    std::vector<Chunk> chunks;
};

/// The thesis' falling cubes, each tested against each other: 0.1 ns a test (as measured for `brute` on two cores), all
/// boxes on every device, a pair a body (assumed), chunks of as many tests each.
Load cubes(double bodies, std::uint32_t chunks);
/// `density`, cut into chunks of as many bodies each: 45 ns and 24 bytes a box, 3 ns and 8 bytes a pair, a pair a body
/// on average. Both the work and the pairs of a chunk differ by up to `spread` either way (assumed), by the seed. Boxes
/// that lie in two chunks are not counted.
Load density(double bodies, std::uint32_t chunks, double spread, std::uint64_t seed);

/// All work at the speed of all devices together: no machine is faster.
double ideal_seconds(const Machine& machine, const Load& load);

}  // namespace clinch::machines
