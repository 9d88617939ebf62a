#include "tests/watchdog.hpp"

#include <catch2/catch.hpp>
#include <chrono>
#include <future>
#include <stdexcept>
#include <string>

using clinch::test::Watchdog;

TEST_CASE("a watchdog whose time is up names the test", "[host]") {
    std::promise<std::string> said;
    const Watchdog watchdog(std::chrono::minutes(0), [&](const std::string& test) { said.set_value(test); });
    CHECK(said.get_future().get() == "a watchdog whose time is up names the test");
}

TEST_CASE("a watchdog that ends in time says nothing", "[host]") {
    bool late = false;
    const auto say = [&](const std::string&) { late = true; };
    { const Watchdog watchdog(std::chrono::minutes(10), say); }
    try {
        const Watchdog watchdog(std::chrono::minutes(10), say);
        throw std::runtime_error("the end of a test that fails");
    } catch (const std::runtime_error&) {
        CHECK_FALSE(late);
    }
    CHECK_FALSE(late);
}
