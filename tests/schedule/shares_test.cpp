#include "src/schedule/shares.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "clinch/error.hpp"
#include "tests/random.hpp"

using namespace clinch;
using detail::Shares;

namespace {

struct Truth {
    double speed, latency;  // work a second, seconds a step
};
using Machine = std::vector<Truth>;

double seconds(const Truth& device, double work) {
    return work > 0.0 ? device.latency + work / device.speed : 0.0;
}

double seconds(const Machine& machine, const std::vector<double>& fractions, double work) {
    double longest = 0.0;
    for (std::size_t i = 0; i < machine.size(); ++i)
        longest = std::max(longest, seconds(machine[i], fractions[i] * work));
    return longest;
}

// The least time any split takes, by bisection: whoever begins in time works until then.
double ideal_seconds(const Machine& machine, double work) {
    double low = 0.0, high = 1e9;
    for (int i = 0; i < 200; ++i) {
        const double middle = 0.5 * (low + high);
        double done = 0.0;
        for (const Truth& device : machine) done += std::max(0.0, middle - device.latency) * device.speed;
        (done < work ? low : high) = middle;
    }
    return high;
}

// One step: what each device did by the fractions and how long it took, off by `noise` at most.
void step(Shares& shares, const Machine& machine, double work, double noise, test::Random& random) {
    std::vector<Shares::Measure> measures;
    for (std::size_t i = 0; i < machine.size(); ++i) {
        const double own = shares.fractions()[i] * work;
        measures.push_back({own, seconds(machine[i], own) * random.between(1.0 - noise, 1.0 + noise)});
    }
    shares.measured(measures);
}

// Without a guess at the speeds: the time after 5 steps beside the ideal one. The 200 steps that follow are nearly all
// within 10 %, too (a trial of a device that does not pay may take longer).
double after_five_steps(const Machine& machine, double noise, std::uint64_t seed) {
    INFO("seed " << seed << ", devices " << machine.size() << ", noise " << noise);
    test::Random random(seed);
    const double work = 1000.0, ideal = ideal_seconds(machine, work);
    Shares shares(std::vector<double>(machine.size(), 1.0));
    for (int i = 0; i < 5; ++i) step(shares, machine, work, noise, random);
    const double ratio = seconds(machine, shares.fractions(), work) / ideal;
    int good = 0;
    for (int i = 0; i < 200; ++i) {
        step(shares, machine, work, noise, random);
        if (seconds(machine, shares.fractions(), work) <= 1.1 * ideal) ++good;
    }
    CHECK(good >= 196);
    CHECK(std::accumulate(shares.fractions().begin(), shares.fractions().end(), 0.0) == Approx(1.0));
    return ratio;
}

Machine with_latencies(const std::vector<double>& speeds, const std::vector<double>& parts) {
    Machine machine;
    const double whole = 1000.0 / std::accumulate(speeds.begin(), speeds.end(), 0.0);
    for (std::size_t i = 0; i < speeds.size(); ++i) machine.push_back({speeds[i], whole * parts[i % parts.size()]});
    return machine;
}

std::vector<double> many_speeds(std::uint64_t seed) {
    test::Random random(seed);
    std::vector<double> speeds(64);
    for (double& speed : speeds) speed = random.between(1.0, 8.0);
    return speeds;
}

}  // namespace

TEST_CASE("shares reach the ideal split's time in five steps", "[host][schedule]") {
    const std::uint64_t seed = 511;
    for (const std::vector<double>& speeds :
         {std::vector<double>{1, 1}, {1, 4}, {1, 8}, {8, 1}, {1, 2, 4, 8}, many_speeds(seed)})
        // Latencies in parts of the time all devices need together.
        for (const std::vector<double>& latencies : {std::vector<double>{0.0}, {0.1}, {0.5}, {0.0, 0.3}, {0.3, 0.0}}) {
            INFO("latencies " << latencies[0] << ", speed of the first " << speeds[0]);
            const Machine machine = with_latencies(speeds, latencies);
            CHECK(after_five_steps(machine, 0.0, seed) <= 1.1);
            // Five measurements that are 10 % off may be off the same way: one seed in 25 may pass 10 %, none 15 %.
            int late = 0;
            for (std::uint64_t i = 0; i < 25; ++i) {
                const double ratio = after_five_steps(machine, 0.1, seed + i);
                CHECK(ratio <= 1.15);
                if (ratio > 1.1) ++late;
            }
            CHECK(late <= 1);
        }
}

TEST_CASE("before any measurement the guesses are the shares", "[host][schedule]") {
    const Shares shares({1.0, 3.0});
    CHECK(shares.fractions()[0] == Approx(0.25));
    CHECK(shares.fractions()[1] == Approx(0.75));
    CHECK(shares.estimate(0).seconds_for_all == 0.0);
}

TEST_CASE("latency and pace are told apart", "[host][schedule]") {
    const Machine machine{{100.0, 2.0}, {300.0, 0.0}};
    test::Random random(1);
    Shares shares({1.0, 1.0});
    for (int i = 0; i < 10; ++i) step(shares, machine, 1000.0, 0.0, random);
    CHECK(shares.estimate(0).seconds_to_begin == Approx(2.0).epsilon(0.1));
    CHECK(shares.estimate(0).seconds_for_all == Approx(10.0).epsilon(0.1));
    CHECK(shares.estimate(1).seconds_for_all == Approx(1000.0 / 300.0).epsilon(0.1));
}

TEST_CASE("a device that is slow to start keeps its share", "[host][schedule]") {
    // A speed-proportional split would give the first one less each time it is late, down to nothing.
    const Machine machine{{800.0, 0.4}, {100.0, 0.0}};
    const double ideal = ideal_seconds(machine, 1000.0);
    for (std::uint64_t seed = 520; seed < 540; ++seed) {
        INFO("seed " << seed);
        test::Random random(seed);
        Shares shares({0.01, 1.0});  // and begins with nearly nothing
        for (int i = 0; i < 8; ++i) step(shares, machine, 1000.0, 0.1, random);
        CHECK(seconds(machine, shares.fractions(), 1000.0) <= 1.1 * ideal);
        CHECK(shares.fractions()[0] > 0.75);
    }
}

TEST_CASE("a device that can not pay is tried ever more rarely, and used when it can", "[host][schedule]") {
    Machine machine{{100.0, 0.0}, {400.0, 50.0}};
    test::Random random(2);
    Shares shares({1.0, 1.0});
    std::vector<int> used;
    for (int i = 0; i < 600; ++i) {
        if (shares.fractions()[1] > 0.0) used.push_back(i);
        step(shares, machine, 1000.0, 0.05, random);
    }
    REQUIRE(used.size() >= 5);
    CHECK(used.size() <= 14);
    const std::size_t last = used.size() - 1;
    CHECK(used[last] - used[last - 1] >= 100);
    CHECK(used[last - 1] - used[last - 2] < used[last] - used[last - 1]);

    SECTION("because it became quick to start") {
        machine[1].latency = 0.0;
        for (int i = 0; i < 1100; ++i) step(shares, machine, 1000.0, 0.05, random);
    }
    SECTION("because the work grew") {
        machine[1].latency = 1.0;  // of 1100
        for (int i = 0; i < 1100; ++i) step(shares, machine, 20000.0, 0.05, random);
    }
    CHECK(shares.fractions()[1] == Approx(0.8).epsilon(0.1));
}

TEST_CASE("work that grows at once lets a device pay without a trial", "[host][schedule]") {
    const Machine machine{{100.0, 0.0}, {400.0, 50.0}};
    test::Random random(3);
    Shares shares({1.0, 1.0});
    for (int i = 0; i < 300; ++i) step(shares, machine, 1000.0, 0.0, random);
    REQUIRE(shares.fractions()[1] == 0.0);
    for (int i = 0; i < 5; ++i) step(shares, machine, 100000.0, 0.0, random);
    CHECK(seconds(machine, shares.fractions(), 100000.0) <= 1.1 * ideal_seconds(machine, 100000.0));
}

TEST_CASE("a device whose speed changes is followed", "[host][schedule]") {
    for (const double factor : {0.2, 5.0}) {
        INFO("factor " << factor);
        Machine machine{{100.0, 0.1}, {100.0, 0.1}, {100.0, 0.1}};
        test::Random random(4);
        Shares shares({1.0, 1.0, 1.0});
        for (int i = 0; i < 30; ++i) step(shares, machine, 1000.0, 0.05, random);
        machine[1].speed *= factor;
        for (int i = 0; i < 6; ++i) step(shares, machine, 1000.0, 0.05, random);
        CHECK(seconds(machine, shares.fractions(), 1000.0) <= 1.1 * ideal_seconds(machine, 1000.0));
    }
}

TEST_CASE("a change of the device that does most is not taken for one of the work", "[host][schedule]") {
    for (const double factor : {0.4, 2.5}) {
        INFO("factor " << factor);
        Machine machine{{400.0, 0.0}, {100.0, 0.0}};
        test::Random random(7);
        Shares shares({1.0, 1.0});
        for (int i = 0; i < 10; ++i) step(shares, machine, 1000.0, 0.05, random);
        const double other = shares.estimate(1).seconds_for_all;
        CHECK(other == Approx(10.0).epsilon(0.1));
        machine[0].speed *= factor;
        for (int i = 0; i < 3; ++i) {
            step(shares, machine, 1000.0, 0.05, random);
            CHECK(shares.estimate(1).seconds_to_begin + shares.estimate(1).seconds_for_all ==
                  Approx(other).epsilon(0.1));
        }
        // All of them: the work.
        for (int i = 0; i < 8; ++i) step(shares, machine, 1000.0, 0.05, random);
        step(shares, machine, 3000.0, 0.05, random);
        CHECK(shares.estimate(1).seconds_for_all == Approx(3.0 * other).epsilon(0.15));
    }
}

TEST_CASE("one step that went wrong does not change the shares", "[host][schedule]") {
    test::Random random(5);
    const Machine machine{{100.0, 0.0}, {100.0, 0.0}, {200.0, 0.0}};
    Shares shares({1.0, 1.0, 1.0});
    for (int i = 0; i < 10; ++i) step(shares, machine, 1000.0, 0.05, random);
    const std::vector<double> before = shares.fractions();
    shares.measured({{250.0, 2.5}, {250.0, 40.0}, {500.0, 2.5}});
    for (std::size_t i = 0; i < 3; ++i) CHECK(shares.fractions()[i] == Approx(before[i]).epsilon(0.05));
}

TEST_CASE("measurements that can not be are ignored", "[host][schedule]") {
    Shares shares({1.0, 3.0});
    const std::vector<double> before = shares.fractions();
    const double infinite = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
    shares.measured({{1.0, 0.0}, {1.0, nan}});
    shares.measured({{0.0, 1.0}, {0.0, 0.0}});
    shares.measured({{1.0, infinite}, {1.0, -1.0}});
    shares.measured({{infinite, 1.0}, {nan, 1.0}});
    shares.measured({{-1.0, 1.0}, {-2.0, 1.0}});
    CHECK(shares.fractions() == before);
    CHECK_THROWS_AS(shares.measured({{1.0, 1.0}}), Error);
    CHECK_THROWS_AS(Shares({1.0, 0.0}), Error);
    CHECK_THROWS_AS(Shares({nan}), Error);
    CHECK(Shares({}).fractions().empty());
}

TEST_CASE("a device not measured keeps its place among the others", "[host][schedule]") {
    // The unit of work and the amount change from step to step; only the first two devices have anything to do.
    Shares shares({1.0, 1.0, 1.0});
    shares.measured({{1.0, 1.0}, {1.0, 1.0}, {1.0, 2.0}});
    for (const double amount : {1.0, 1.2, 1.5, 1.9, 2.4, 3.0, 9.0, 20.0, 40.0, 3.0, 2.0, 1.0})
        for (int i = 0; i < 8; ++i) shares.measured({{amount, amount}, {amount, amount}, {0.0, 0.0}});
    CHECK(shares.fractions()[0] == Approx(shares.fractions()[1]));
    CHECK(shares.fractions()[2] / shares.fractions()[0] == Approx(0.5).epsilon(0.25));
}

TEST_CASE("retired devices get nothing until restored", "[host][schedule]") {
    Shares shares({1.0, 1.0, 2.0});
    test::Random random(6);
    const Machine machine{{100.0, 0.0}, {200.0, 0.0}, {100.0, 0.0}};
    for (int i = 0; i < 5; ++i) step(shares, machine, 1000.0, 0.0, random);
    shares.retire(1);
    CHECK(shares.fractions()[1] == 0.0);
    CHECK(shares.fractions()[0] == Approx(0.5).epsilon(0.05));
    for (int i = 0; i < 5; ++i) step(shares, machine, 1000.0, 0.0, random);
    shares.restore(1);
    CHECK(shares.fractions()[1] == Approx(0.5).epsilon(0.05));
    for (const std::size_t i : {0u, 1u, 2u}) shares.retire(i);
    CHECK(shares.fractions() == std::vector<double>(3, 0.0));
    shares.measured({{1.0, 1.0}, {1.0, 1.0}, {1.0, 1.0}});
    CHECK(shares.fractions() == std::vector<double>(3, 0.0));
    shares.restore(0);
    CHECK(shares.fractions() == std::vector<double>{1.0, 0.0, 0.0});
}
