// Makes OpenCL calls fail, one after the other, and checks what is said of it and what is left behind.
#pragma once

#include <CL/cl.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "clinch/context.hpp"
#include "clinch/error.hpp"
#include "clinch/view.hpp"
#include "src/device/context_impl.hpp"
#include "tests/random.hpp"
#include "tests/watchdog.hpp"

namespace clinch::test {

/// Counts the OpenCL calls of a context's devices, on whatever threads they are made, and has some of them fail. A
/// watchdog runs, anew from each watch() or fail(): no failure may hang what is asked of the devices.
class Faults {
public:
    /// Whether a call is to fail: its device, its name, and its number among those of this name
    /// since watch() or fail().
    using Choice = std::function<bool(std::size_t device, const std::string& name, std::size_t number)>;

    /// No device of `context` may be open yet. This object is to outlive the work on it.
    explicit Faults(Context& context) {
        context.impl().fault_hook = [this](std::size_t device, const char* name) { return ask(device, name); };
    }
    Faults(const Faults&) = delete;
    Faults& operator=(const Faults&) = delete;

    /// From now on calls are counted anew and none fails.
    void watch() { fail({}, CL_SUCCESS); }
    /// From now on calls are counted anew, and those chosen fail with `status`.
    void fail(Choice choice, cl_int status) {
        watchdog_.emplace();
        const std::lock_guard<std::mutex> lock(mutex_);
        choice_ = std::move(choice);
        status_ = status;
        calls_.clear();
        counts_.clear();
        failed_.clear();
    }
    /// Of the calls of this name, that of this number fails; and with `lasting` every call after it.
    void fail(const std::string& name, std::size_t number, cl_int status, bool lasting = false) {
        fail(
            [=, begun = false](std::size_t, const std::string& n, std::size_t k) mutable {
                if (begun && lasting) return true;
                begun = k == number && n == name;
                return begun;
            },
            status);
    }
    /// Names of the calls since watch() or fail(), in order.
    std::vector<std::string> calls() const {
        const std::lock_guard<std::mutex> lock(mutex_);
        return calls_;
    }
    /// Name of the first call that failed; empty: none has.
    std::string failed() const {
        const std::lock_guard<std::mutex> lock(mutex_);
        return failed_.empty() ? std::string() : failed_.front();
    }
    /// Names of all that failed.
    std::vector<std::string> all_failed() const {
        const std::lock_guard<std::mutex> lock(mutex_);
        return failed_;
    }

private:
    cl_int ask(std::size_t device, const char* name) {
        const std::lock_guard<std::mutex> lock(mutex_);
        calls_.emplace_back(name);
        const std::size_t number = counts_[name]++;
        if (!choice_ || !choice_(device, calls_.back(), number)) return CL_SUCCESS;
        failed_.push_back(calls_.back());
        return status_;
    }
    mutable std::mutex mutex_;
    Choice choice_;
    cl_int status_ = CL_SUCCESS;
    std::vector<std::string> calls_;
    std::map<std::string, std::size_t> counts_;  // of each name
    std::vector<std::string> failed_;
    std::optional<Watchdog> watchdog_{std::in_place};
};

/// For a context of one device.
inline ContextOptions first_device() {
    ContextOptions options;
    options.devices.indices = {0};
    return options;
}

/// Faults to try of each kind of call: `wanted`, but fewer on llvmpipe, which compiles every kernel object anew.
inline std::size_t faults_of_a_name(const Context& context, std::size_t wanted) {
    return context.devices()[0].quirks.empty() ? wanted : 2;
}

/// What the message of an Error holds when a call of this name has failed.
inline std::string told_of(const std::string& call) {
    if (call == "clCreateContext" || call == "clCreateCommandQueue") return "opening device '";
    if (call == "clCreateProgramWithSource" || call == "clBuildProgram") return "kernel module '";
    if (call == "clCreateBuffer") return "allocating ";
    if (call == "clCreateKernel") return "creating kernel '";
    if (call == "clEnqueueNDRangeKernel") return "launching kernel '";
    return call;
}

/// An Error for one of `calls`, which failed with `status`, says so.
inline void check_told(const Error& error, const std::vector<std::string>& calls, cl_int status) {
    INFO(error.what());
    const bool short_of = status == CL_OUT_OF_RESOURCES || status == CL_MEM_OBJECT_ALLOCATION_FAILURE;
    CHECK(error.code() == (short_of ? ErrorCode::OutOfMemory : ErrorCode::DeviceFailed));
    CHECK(error.opencl_status() == status);
    const std::string what = error.what();
    CHECK(std::any_of(calls.begin(), calls.end(),
                      [&](const std::string& call) { return what.find(told_of(call)) != std::string::npos; }));
}
inline void check_told(const Error& error, const std::string& call, cl_int status) {
    check_told(error, std::vector<std::string>{call}, status);
}

struct Fault {
    std::string call;
    std::size_t number;  ///< among the calls of this name
    cl_int status;
};

/// The faults to try among `calls`: each of them for want of resources, but at most `most` of a name, drawn with
/// `seed`, the first and the last among them; the first of each name for another reason, too.
inline std::vector<Fault> faults_among(const std::vector<std::string>& calls, std::size_t most, std::uint64_t seed) {
    std::map<std::string, std::vector<std::size_t>> by_name;
    for (const std::string& name : calls) by_name[name].push_back(by_name[name].size());
    Random random(seed);
    std::vector<Fault> faults;
    for (auto& [name, numbers] : by_name) {
        faults.push_back(
            {name, 0, name == "clCreateBuffer" ? CL_MEM_OBJECT_ALLOCATION_FAILURE : CL_DEVICE_NOT_AVAILABLE});
        while (numbers.size() > std::max<std::size_t>(most, 2))
            numbers.erase(numbers.begin() + 1 + static_cast<std::ptrdiff_t>(random.below(numbers.size() - 2)));
        for (const std::size_t number : numbers) faults.push_back({name, number, CL_OUT_OF_RESOURCES});
    }
    return faults;
}

/// Those of `calls` that were made as often in `others`, too: how work-items share the work is a matter of chance, and
/// with it whether a few last calls are made.
inline std::vector<std::string> made_in_both(const std::vector<std::string>& calls,
                                             const std::vector<std::string>& others) {
    std::map<std::string, std::size_t> left;
    for (const std::string& name : others) ++left[name];
    std::vector<std::string> both;
    for (const std::string& name : calls)
        if (left[name] > 0) {
            --left[name];
            both.push_back(name);
        }
    return both;
}

template <class T>
std::string bytes(View<const T> values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// A call under test: `make` gives an object, as fresh as it is to be when the call is made, and `ask` makes the call
/// on it and returns the bytes of its answer, `expected` ones if all goes well.
template <class Make, class Ask>
struct Trial {
    Make make;
    Ask ask;
    std::string expected;
    std::size_t most_of_a_name;  ///< faults tried of each kind of call
    std::uint64_t seed;          ///< by which they are drawn

    bool may_pass = false;         ///< some failures are to be lived with: the answer is then there all the same
    std::string undisturbed = {};  ///< the answer where nothing has failed, if that may be another

    bool same(const std::string& answer) const { return answer == expected; }
    bool same_undisturbed(const std::string& answer) const {
        return answer == (undisturbed.empty() ? expected : undisturbed);
    }
};
template <class Make, class Ask>
Trial(Make, Ask, std::string, std::size_t, std::uint64_t, bool = {}, std::string = {}) -> Trial<Make, Ask>;

/// Has call after call fail, each second one with all that follow it: each failure is told, and the same object, asked
/// again, gives the answer. Afterwards no memory of the devices is left in use.
template <class Make, class Ask>
void check_faults(Context& context, Faults& faults, const Trial<Make, Ask>& trial) {
    std::vector<std::string> calls;
    for (int turn = 0; turn < 4; ++turn) {  // the first builds kernels
        auto object = trial.make();
        faults.watch();
        CHECK(trial.same_undisturbed(trial.ask(object)));
        calls = turn < 2 ? faults.calls() : made_in_both(calls, faults.calls());
    }
    REQUIRE(calls.size() > 5);
    const std::vector<Fault> to_try = faults_among(calls, trial.most_of_a_name, trial.seed);
    std::size_t struck = 0;
    bool lasting = false;
    for (const Fault& fault : to_try) {
        lasting = !lasting;
        INFO(fault.call << " number " << fault.number << " fails with " << fault.status
                        << (lasting ? ", and all after it" : "") << ", seed " << trial.seed);
        auto object = trial.make();
        faults.fail(fault.call, fault.number, fault.status, lasting);
        try {
            const std::string answer = trial.ask(object);
            CHECK((trial.may_pass || faults.failed().empty()));
            CHECK(trial.same_undisturbed(answer));
            faults.watch();
            continue;
        } catch (const Error& error) {
            CHECK(faults.failed() == fault.call);
            check_told(error, fault.call, fault.status);
            ++struck;
        }
        faults.watch();
        CHECK(trial.same(trial.ask(object)));
    }
    // By chance this time fewer were made.
    CHECK(struck > to_try.size() * (trial.may_pass ? 1 : 3) / 4);
    for (const DeviceReport& report : context.report()) CHECK(report.bytes == 0);
}

}  // namespace clinch::test
