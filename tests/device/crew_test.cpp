// Devices side by side: threads, what they throw, and devices that are taken out of use.
#include "src/device/crew.hpp"

#include <catch2/catch.hpp>
#include <condition_variable>
#include <mutex>
#include <numeric>
#include <stdexcept>

#include "clinch/error.hpp"
#include "src/device/context_impl.hpp"

using namespace clinch;
using detail::is_device_fault;
using detail::run_crew;

TEST_CASE("a crew runs all at once", "[host]") {
    constexpr std::size_t count = 5;
    std::mutex mutex;
    std::condition_variable all_there;
    std::size_t there = 0;
    const auto thrown = run_crew(count, [&](std::size_t) {
        std::unique_lock<std::mutex> lock(mutex);
        if (++there == count) all_there.notify_all();
        all_there.wait(lock, [&] { return there == count; });
    });
    CHECK(thrown == std::vector<std::exception_ptr>(count));
    CHECK(run_crew(0, [](std::size_t) {}).empty());
}

TEST_CASE("what one of a crew throws is told apart, and the others end their work", "[host]") {
    std::vector<int> done(4, 0);
    const auto thrown = run_crew(4, [&](std::size_t k) {
        if (k == 0) throw Error(ErrorCode::DeviceFailed, "gone", -2);
        if (k == 2) throw std::runtime_error("asked wrongly");
        done[k] = 1;
    });
    CHECK(done == std::vector<int>{0, 1, 0, 1});
    REQUIRE(thrown[0] != nullptr);
    CHECK(thrown[1] == nullptr);
    REQUIRE(thrown[2] != nullptr);
    CHECK(thrown[3] == nullptr);
    CHECK(is_device_fault(thrown[0]));
    CHECK_FALSE(is_device_fault(thrown[2]));
    CHECK_FALSE(is_device_fault(std::make_exception_ptr(Error(ErrorCode::LimitExceeded, "too many"))));
    CHECK_FALSE(is_device_fault(std::make_exception_ptr(Error(ErrorCode::DeviceFailed, "not one for this"))));
    CHECK(detail::message_of(thrown[0]) == "gone");
    CHECK(detail::message_of(thrown[2]) == "asked wrongly");
}

TEST_CASE("a device that is taken out of use is no more chosen; the last one stays", "[host]") {
    Context context = Context::host_only();
    Context::Impl& impl = context.impl();
    CHECK(impl.crew().empty());
    std::vector<std::string> told;
    impl.options.log = [&](const std::string& line) { told.push_back(line); };
    for (const std::uint32_t units : {4u, 16u, 8u}) {
        DeviceInfo info;
        info.name = "of " + std::to_string(units);
        info.compute_units = units;
        impl.infos.push_back(info);
        impl.devices.emplace_back();
    }
    CHECK(impl.crew() == std::vector<std::size_t>{1, 0, 2});
    CHECK(impl.retire(1, "it is on fire"));
    CHECK(impl.primary() == 2);
    CHECK(impl.crew() == std::vector<std::size_t>{2, 0});
    CHECK(told == std::vector<std::string>{"device 1 ('of 16') failed and is not used any more: it is on fire"});
    CHECK(impl.retire(1, "again"));
    CHECK(told.size() == 1);
    CHECK(impl.retire(0, ""));
    CHECK_FALSE(impl.retire(2, "the last"));
    CHECK(impl.crew() == std::vector<std::size_t>{2});
}
