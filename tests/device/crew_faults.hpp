// Several devices of which one fails, or all do: what is said of it, and what the next call gives.
#pragma once

#include <CL/cl.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/device/devices.hpp"
#include "tests/device/faults.hpp"

namespace clinch::test {

/// From a call on, one of a device fails, and all after it.
inline Faults::Choice from_call(std::size_t device, std::size_t number) {
    return [=, seen = std::size_t{0}](std::size_t d, const std::string&, std::size_t) mutable {
        return d == device && seen++ >= number;
    };
}
/// One call of a device fails.
inline Faults::Choice one_call(std::size_t device, std::size_t number) {
    return [=, seen = std::size_t{0}](std::size_t d, const std::string&, std::size_t) mutable {
        return d == device && seen++ == number;
    };
}

/// A context of several devices whose calls can be made to fail; fresh again at each reset().
struct Failing {
    Context context;
    Faults faults{context};
    /// The devices that the environment offers, over and over; or with `alike` the first one, several times.
    explicit Failing(std::uint32_t devices, bool alike = false)
        : context(alike ? several(0, devices) : several(devices)) {
        context.impl().least_boxes_a_device = 1;
    }
    void reset(bool closed) {
        faults.watch();
        context.impl().retired.clear();
        if (closed)
            for (auto& device : context.impl().devices) device.reset();
    }
    /// Calls that each device makes in `work`.
    template <class Work>
    std::vector<std::size_t> count(const Work& work) {
        std::vector<std::size_t> counts(context.devices().size(), 0);
        faults.fail(
            [&](std::size_t d, const std::string&, std::size_t) {
                ++counts[d];
                return false;
            },
            CL_SUCCESS);
        work();
        faults.watch();
        return counts;
    }
    std::size_t retired() const {
        const auto& list = context.impl().retired;
        return static_cast<std::size_t>(
            std::count_if(list.begin(), list.end(), [](const std::string& why) { return !why.empty(); }));
    }
};

/// Numbers of calls to fail at: some of `count`, the first and last among them.
inline std::vector<std::size_t> numbers_of(std::size_t count, std::size_t most, Random& random) {
    std::vector<std::size_t> numbers{0, count - 1};
    while (numbers.size() < std::min(most, count)) numbers.push_back(random.below(count));
    return numbers;
}

/// Has calls of one device after the other fail, each second one with all that follow it, and then calls of all devices
/// at once. Either the answer is there all the same or, where `may_throw` and where all fail, the failure is told; and
/// the same object, asked again, gives the answer. Afterwards no memory of the devices is left in use.
template <class Make, class Ask>
void check_crew_faults(Failing& failing, const Trial<Make, Ask>& trial, bool may_throw = false) {
    Random random(trial.seed);
    std::string first, second;  // answers of one object where nothing fails
    std::vector<std::size_t> calls;
    for (int turn = 0; turn < 2; ++turn) {  // the first builds kernels
        failing.reset(false);
        auto object = trial.make();
        calls = failing.count([&] { first = trial.ask(object); });
        second = trial.ask(object);
        CHECK(trial.same_undisturbed(first));
    }
    const std::size_t devices = calls.size();
    std::size_t tried = 0, struck = 0;
    bool lasting = false;
    const auto try_fault = [&](const Faults::Choice& choice, bool must_throw) {
        failing.reset(false);
        auto object = trial.make();
        failing.faults.fail(choice, CL_OUT_OF_RESOURCES);
        ++tried;
        bool threw = false;
        try {
            const std::string answer = trial.ask(object);
            CHECK((answer == first));
            CHECK((!must_throw || failing.faults.failed().empty()));
        } catch (const Error& error) {
            threw = true;
            CHECK((may_throw || must_throw));
            check_told(error, failing.faults.all_failed(), CL_OUT_OF_RESOURCES);
        }
        if (!failing.faults.failed().empty()) ++struck;
        failing.faults.watch();
        const std::string again = trial.ask(object);
        CHECK((threw ? trial.same(again) : again == second));
    };
    for (std::size_t device = 0; device < devices; ++device) {
        if (calls[device] == 0) continue;  // it has no part in such calls
        for (const std::size_t number : numbers_of(calls[device], trial.most_of_a_name, random)) {
            lasting = !lasting;
            INFO("device " << device << " fails in call " << number << " of " << calls[device]
                           << (lasting ? " and all after it" : "") << ", seed " << trial.seed);
            try_fault(lasting ? from_call(device, number) : one_call(device, number), false);
        }
    }
    CHECK(struck > tried / 4);  // which device does what is a matter of chance, and with it how many calls it makes
    for (const std::size_t number : numbers_of(calls[failing.context.impl().primary()], 3, random)) {
        INFO("all devices fail, from call " << number << " on, seed " << trial.seed);
        try_fault([=, seen = std::size_t{0}](std::size_t, const std::string&,
                                             std::size_t) mutable { return seen++ >= number; },
                  true);
    }
    failing.reset(false);
    for (const DeviceReport& report : failing.context.report()) CHECK(report.bytes == 0);
}

}  // namespace clinch::test
